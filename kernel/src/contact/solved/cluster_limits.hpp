#pragma once

#include <cstddef>
#include <cstdint>

/// These constants bound the substeps of clusters and say how exactly they are solved. What a user may want
/// otherwise stands in ContactSettings.
namespace plumb::detail::contact_limits {

/// A rod turns by at most this angle (rad) in a substep. Corrections keep to the gradients of the start, so
/// at larger angles they converge more slowly. At this one each takes a digit off the violation.
inline constexpr double most_turn = 0.35;
/// In flight a linkage turns by at most the first of these (rad) in a step, if no accuracy is asked for. With
/// one, comparison finds errors, and the second only keeps steps sound.
inline constexpr double most_turn_in_flight = 0.25, most_turn_if_watched = 1;
/// Two shapes that approach do so by at most this share of their radii in a substep.
inline constexpr double most_approach = 0.5;
/// The reach of an island leaves out a force that would throw it farther than this many of its sizes in a
/// step. Larger values join more islands into a cluster.
inline constexpr double farthest_throw = 10;
/// A pull that moved an island by more than this share of its size in a substep was a hit, and is not
/// expected again. The next substep starts from smaller pulls, which are likely to last.
inline constexpr double farthest_pull = 0.05;
/// A step is cut into at most this many substeps.
inline constexpr double most_cuts = 4096;
/// What can be relaxed is not cut to substeps that are shorter than this share of what they should be, but
/// relaxed in this many or, if it is fast, more.
inline constexpr double few_cuts = 0.25;
inline constexpr std::uint32_t few_relaxed = 4, most_relaxed = 16;
/// What touches nets is relaxed with rods off their lengths only once substeps are shorter than this share,
/// or were halved so often in the step. With a quarter, crates on nets that sag a little left rods strained
/// by a fifth. What begins in a crate would be halved on for seconds.
inline constexpr double few_cuts_of_nets = 1.0 / 16;
inline constexpr int most_halvings_of_nets = 16;
/// What would sink into ground by being relaxed is cut on, to this share, before it is relaxed all the same.
inline constexpr double least_sunk = 1.0 / 512;
/// Where that brings them into ground, it is tried so often to hold them out of it.
inline constexpr int most_holds = 4;
/// Where rods do not fit, they are left off their lengths by up to so many times what would be in ground.
/// Relaxation may leave more, which wanders.
inline constexpr double most_drawn = 4;
/// What is brought to its lengths may go this share of its thickness into others, which push it back. What
/// would go farther is left off its lengths.
inline constexpr double most_in_others = 0.1;
/// What is held out of ground goes no farther for that than so many times as deep as it was.
inline constexpr double most_pushed = 16;
/// What is looked for at an instant is looked for in a substep of this length (s).
inline constexpr double instant = 1e-9;
/// Rods that bringing them to their lengths moves by no more than this share of their sizes fitted before.
inline constexpr double unfitting = 1e-6;
/// Rods that stand straight on ground buckle to a share of their sizes between these, which is made wider by
/// a factor until they have room. The response to a push is its square, and well above what counts as held.
inline constexpr double least_nudge = 1e-2, most_nudge = 0.4, wider = 1.3;
/// That does so many times the work of lifting the island by what is asked for, at most. Taut ropes with
/// loads answer as little as rods that stand, and have nothing to buckle.
inline constexpr double most_work_of_room = 4;
/// What stands upright answers by no more than this share above what it would answer with as one. Rods then
/// lean to this share of their sizes, which changes their lengths by less than what counts as solved.
inline constexpr double balanced = 1e-9, faint = 1e-6;
/// Islands that touched each other in more places than these are a crowd, and so are nets that touched
/// anything. They take longer to solve than to relax.
inline constexpr std::size_t few_touching = 24;
/// A step in which ground moves a cluster is halved so often before rods may be off their lengths. What it
/// presses against other ground would be halved on for a tenth of a second.
inline constexpr int most_if_pressed = 128;
/// What could not be solved is a crowd for so many steps.
inline constexpr std::uint8_t patience = 15;
/// A step is cut into at most this many substeps because one would gain energy.
inline constexpr double most_guards = 64;
/// A step is cut into at most this many substeps because something is in ground still. With 64 corners of
/// thin boxes at 100 m/s stayed 6 mm deep, and with 256 none did.
inline constexpr double most_missed_cuts = 1024;
/// Islands at rest may gain this share of the energy that lifts them by their height. Larger values repeat
/// fewer substeps and let resting things creep.
inline constexpr double unnoticed = 3e-9;
/// A substep is cut where contact would give more than this share of the energy of motion, as velocities were
/// not found then. With all of it, it was taken from all motion, which stopped tracks round wheels.
inline constexpr double most_lifting = 0.5;
/// Contact that would gain more than this share of the energy of motion is counted as such. Less is what the
/// order of a substep explains where rods turn by a quarter of a radian.
inline constexpr double gained = 1e-2;
/// Islands with elastics may have gained this share of the largest energy of their motion and elastics, which
/// leaves room for the swings of a symplectic rule. Without weight energy then stays below 1/(1 - 0.25) of
/// what it was. Smaller values damp scenes whose energy only swings.
inline constexpr double most_gained = 0.25;
/// In free flight an energy error of this share stays uncorrected. Correcting a rigid motion would change its
/// momentum.
inline constexpr double let_be = 1e-6;
/// Constraints count as solved once they are violated by no more than this share of their lengths. Larger
/// values take fewer corrections and leave rods longer or shorter.
inline constexpr double exact = 1e-8;
/// Islands with elastics go on to this, as far as rounding lets them. Larger values let their energy drift.
inline constexpr double exact_if_elastic = 1e-12;
/// Gradient mid goes on as far as rounding lets it, and its energy drifts with what is left.
inline constexpr double exact_if_mid = 1e-16;
/// Cables are let go or taken up at most so often in a substep. Few substeps need more than two.
inline constexpr int most_switches = 8;
/// A substep makes at most so many corrections of its constraints.
inline constexpr int most_corrections = 16;
/// A correction that leaves more than this share of what it found was along gradients too far off. A
/// factorisation of mid's matrix pays then.
inline constexpr double good_share = 0.1;
/// It makes more, up to so many, where constraints are nearly solved and sweeps still come closer. In a tower
/// of n boxes sweeps grow as n², and what they leave out lifts some of them.
inline constexpr int most_patient_corrections = 80;
/// They do if within so many corrections no more than this share is left of what they would change.
inline constexpr double much_better = 0.8;
inline constexpr int most_idle = 8;
/// The last sweep may always change a position by this much (m, times the length scale). It matters where
/// nothing has weight, so that gravity sets no scale.
inline constexpr double least_still = 1e-9;
/// Once contacts have lifted something, sweeps go on until they change this share of what they usually may,
/// to the end of the step.
inline constexpr double tighter = 1e-2;
/// A round of sweeps ends once a sweep changes less than this share of what the first one did. The rest waits
/// for corrections, which change about as much. A share of 0.1 costs 4 % of the step and leaves no smaller
/// error.
inline constexpr double rough = 0.3;
/// A substep sweeps its contacts at most this often before a correction. After one it begins with a quarter
/// of that, which is doubled beyond several_rows where it was not enough but some of the last few rounds came
/// much closer. Changes rise and fall with momentum, so that one round alone says little.
inline constexpr int most_sweeps = 60, most_idle_rounds = 3;
/// Beyond so many rows of contacts rounds get longer, and have momentum from the start after a correction. A
/// block of twelve on a slope just below its angle of friction crept with that.
inline constexpr std::size_t several_rows = 24;
/// If none did, and of a crowd, so many times ContactSettings::tolerance is close enough. Walls of bricks
/// that were hit came no closer in halves of the step either.
inline constexpr double close_enough = 10;
/// What falls together pushes along normals alone first, at most so often.
inline constexpr int most_cold_sweeps = 120;
/// What touches a net is swept so often, and so far, before every correction: one of a net takes as long as
/// some fifty sweeps. A ball that is heavier than what catches it takes a hundred.
inline constexpr int most_sweeps_on_net = 200;
inline constexpr double rough_on_net = 0.1;
/// A substep of a cluster with nets is no longer than the one before if that had to be halved, and else so
/// many times as long at most. What is tried in vain takes as long as what is not.
inline constexpr double grows_on_net = 1.5;
/// So many sweeps have no momentum, since most substeps need no more.
inline constexpr int sweeps_alone = 10;
/// Momentum has led away once a sweep changes so many times what one did before in its round. In piles it
/// makes changes rise to four times. Friction of figures, which push on far ends, threw it to thirty times.
inline constexpr double thrown_off = 10;
/// A substep may leave so many times what the last sweep may always change, where it takes corrections.
inline constexpr double left_by_sweeps = 10;
/// Islands that rest tremble if they are no faster than so many times what sweeps leave of weight. With one
/// of these, towers of ten boxes took three times as long in short substeps. With ten, boxes did not start on
/// slopes of 0.001.
inline constexpr double trembling = 3;
/// Where directions are not those of the start, what sweeps change turns pulls, so that corrections wait for
/// them. After so many, sweeps go on only while they change more than is let be in the end.
inline constexpr int most_turning_sweeps = 3;
/// Where an island has more sides of contacts, pushes are found freely, and else by its responses to each.
/// Those take the square of this number of responses.
inline constexpr std::size_t most_responses = 256;
/// Responses of an island's sides are kept if they are no more than so many lanes of numbers, a megabyte.
/// Else what pushes do is solved for anew, which costs less than to add up so many.
inline constexpr std::size_t most_kept_responses = 16384;
/// So many passes over contacts go before a solve there. One more costs little beside it.
inline constexpr int free_passes = 2;
/// Beyond so many rows of contacts some come and go in each correction. Constraints may then get worse for a
/// while, as where contacts stand in the matrix: of 64 figures in a heap one or the other did in most
/// substeps, which were cut for all.
inline constexpr std::size_t few_rows = 128;
/// Velocities after contact are swept and corrected in at most this many rounds.
inline constexpr int most_rounds = 4;
/// A place counts as held if a push moves it by less than this share of what it would move a free linkage by.
/// Held places are not pushed, because their response is rounding.
inline constexpr double held_response = 1e-8;
/// What stands on ground is straight, or nearly straight, if a push there moves it by less than this share of
/// what it would move free particles by. Where no positions are found straight rods buckle, and cables let go
/// that are nearly so.
inline constexpr double straight = 1e-3, nearly_straight = 0.1;
/// A place counts as held, too, if it moves by no more than this many times what the matrix lets all rods
/// give.
inline constexpr double rounding = 2;
/// An island that touches ground in more places than these holds them in its own matrix. With fewer,
/// responses of each place cost less.
inline constexpr std::size_t few_on_ground = 16;
/// Where these are not found there, up to so many are swept, too.
inline constexpr std::size_t most_swept_ground = 128;
/// Rods rock on round ground as stiffly as they pull across themselves: by pull / length, times the square of
/// the substep. They are too stiff for rows where that is more than this share of the lightest mass.
inline constexpr double rocks = 0.01;
/// Steps along the edge of Coulomb's cone are shortened where they would overshoot by more than this share,
/// as sweeps get rid of smaller ones as fast. With momentum all are.
inline constexpr double most_overshoot = 0.5;
/// Overlaps that contradict each other, as of two figures in one place, end as far as they agree. Sweeps keep
/// the first share of what pushes them apart, so that one alone ends half as fast, and the second of what
/// keeps them from becoming deeper. With all of that a frame of ten figures in one place took 13 s. What
/// pushed in the last substep does not yield but for the share that the third leaves out, so that a tower
/// carries itself. What is squeezed would be pushed ever harder without that.
inline constexpr double yielding = 0.5, yielding_deeper = 0.95, yielding_keeps = 0.995;
/// Sweeps of what yields go on from no more than this share of what all weigh, which four corners of a face
/// carry. With all of it 5 of 32 stacks between floors and ceilings flew apart after seconds.
inline constexpr double yielding_carries = 0.25;
/// Contacts in the matrix are solved once their pushes lack no more than this share of the largest. A larger
/// share takes fewer corrections and leaves other velocities.
inline constexpr double ground_enough = 1e-7;
/// Bounds on friction follow the normal pushes through so many corrections, and stay then.
inline constexpr int bounds_follow_for = 10;
/// While they do, constraints may be violated by this share of their lengths.
inline constexpr double most_disturbed = 1e-5;
/// Gaps to round ground follow where lines are taken through so many. More of them would close in slowly.
inline constexpr int gaps_follow_for = 8;
/// Contacts in the matrix take at most so many corrections.
inline constexpr int most_ground_corrections = 20;

/// Velocities at the end of a substep may have so many times the energy that it and anchors give. Rods that
/// are levers give some hundred times.
inline constexpr double most_aside = 1e3;

}  // namespace plumb::detail::contact_limits
