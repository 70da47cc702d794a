// How wide worlds are drawn over each other, so that each is seen around the next where they lie in one place.

// Of the first world, which is a ghost, and the others. What has a size nearly keeps it.
const THIN = { rods: [2.4, 1.1, 0.75, 0.45], balls: [1.5, 1, 0.8, 0.6] };
const SIZED = { rods: [1.12, 1, 0.88, 0.76], balls: [1.12, 1, 0.88, 0.76] };
const ALONE = { level: 0, rods: 1, balls: 1 };

/** Returns how much wider than usual the rods and balls of a world are, and its `level` over others in the same place. */
export function widthOf(number, count, isSized) {
  if (count < 2) return ALONE;
  const { rods, balls } = isSized ? SIZED : THIN;
  return { level: number, rods: rods[number], balls: balls[number] };
}
