#!/usr/bin/env python3
"""What the command says of a run, and how it refuses what nothing reads or what is not there.

usage: command_test.py PLUMB SCRATCH
"""
import json
import pathlib
import subprocess
import sys

# The words that are typed, and what the message begins with.
REFUSED = {
    "run chain --budget-us 100": "--budget-us: nothing reads budget: method auto solves every island",
    "run chain --tolerance 1e-3": "--tolerance: nothing reads tolerance: method auto relaxes nothing",
    "run chain --method direct --tolerance 1e-3": "--tolerance: nothing reads tolerance: method direct",
    "run chain --sweeps 20": "--sweeps: nothing reads sweeps: ",
    "run chain --sweeps 10": "--sweeps: nothing reads sweeps: ",
    "run chain --weights mass": "--weights: nothing reads weights: ",
    "run chain --layout soa": "--layout: nothing reads layout: ",
    "run chain --method relax --time-order 4": "--time-order: method relax does not read time order; it is read by direct",
    "run chain --damping-ratio 4": "--damping-ratio: method auto does not read damping ratio; it is read by springs",
    "run chain --method springs --most-work 9": "--most-work: method springs does not read most work",
    "run chain --method springs --forces SCRATCH/forces.csv": "--forces: method springs does not read tensions",
    "run chain --length-scale 3": "--length-scale: nothing reads it",
    "run chain --sleep-time 3": "--sleep-time: nothing reads it",
    "run chain --save-at 1": "--save-at says when to write files",
    "info humanoid:body=thin --layout soa": "--layout: nothing reads it",
    "run chain --substep 4": "no option '--substep'; `plumb run --help` lists those there are. Did you mean --substeps?",
    "rnu chain": "no command 'rnu'; known are run, info, humanoid, fall, frontier, thesis, scale, profile, stability, "
    "truth, view. Did you mean run?",
    "run chain links=5": "nothing takes 'links=5'",
    "run chain --stepz 4": "no option '--stepz'; `plumb run --help` lists those there are. Did you mean --substeps?",
    "run chain --budget 4": "no option '--budget'; `plumb run --help` lists those there are. Did you mean --budget-us?",
    "run rop": "no scene 'rop': there is no such file, and the generators are chain, thesis5, line, winch, net, ensemble, "
    "ring, truss, rods5, tree, humanoid, graph, crowd, stick_box, drop, wire, rope, heap, drape, terrain, boxes, pile, "
    "shot. Did you mean rope?",
}

# What is typed, and a line of what is printed.
PRINTED = {
    "run drape:size=12 --duration 0.5": "solved all at once, relaxed where they touch, gradient ",
    "run chain:links=3 --method relax --sweeps 10 --omega 1 --duration 0.1": "at most 10 sweeps",
    "run rope:links=5 --duration 0.1": "5 rods solved all at once, gradient ",
    "run SCRATCH/bare.json --duration 0.1": "shapes    2 movable particles have no shape (capsules, hulls), and will",
    "info SCRATCH/strained.json": "start      rods did not start at their lengths, rod 0 by 25 %",
    "run SCRATCH/strained.json --duration 0.1": "rod 0 by 25 %; particles moved by at most 0.1",
    "run SCRATCH/strained.json --duration 0.1 --method relax": "rod 0 by 25 %; steps move particles for that",
    "info SCRATCH/bare.json": "shapes     2 movable particles have no shape (capsules, hulls), and will",
    "info chain:links=3": "bytes/projection",
    "run net:width=4 --help": "This scene, with its parameters as they are by default:\n  net:width=32,",
    "run --help": "  net:width=32,",
}

# What is typed, and what is not printed, since it would be empty or of no use.
LEFT_OUT = {"info rope": "bytes/projection", "run net --help": "six rods with mass that branch"}

# A rod above a plane, without a capsule.
BARE = {
    "plumb": 1,
    "particles": [{"position": [x, 1, 0], "mass": 1} for x in (0, 1)],
    "rods": [{"a": 0, "b": 1}],
    "planes": [{"normal": [0, 1, 0]}],
}
# A rod of 0.8 m between particles that are 1 m apart.
STRAINED = {**BARE, "rods": [{"a": 0, "b": 1, "length": 0.8}], "planes": []}


def main():
    plumb, scratch = sys.argv[1], pathlib.Path(sys.argv[2])
    scratch.mkdir(parents=True, exist_ok=True)
    for name, scene in {"bare": BARE, "strained": STRAINED}.items():
        (scratch / f"{name}.json").write_text(json.dumps(scene))
    complaints = []
    for typed in [*REFUSED, *PRINTED, *LEFT_OUT]:
        words = typed.replace("SCRATCH", str(scratch)).split()
        done = subprocess.run([plumb, *words], capture_output=True, text=True, check=False)
        if typed in REFUSED:
            is_right = done.returncode == 2 and done.stderr.startswith("plumb: " + REFUSED[typed])
        else:
            is_said = typed in PRINTED and PRINTED[typed] in done.stdout
            is_said |= typed in LEFT_OUT and LEFT_OUT[typed] not in done.stdout
            is_right = done.returncode == 0 and is_said
        if not is_right:
            complaints.append(f"plumb {typed}: {done.returncode}\n{done.stdout}{done.stderr}")
    print("\n".join(complaints) or f"{len(REFUSED) + len(PRINTED) + len(LEFT_OUT)} commands say what they should")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
