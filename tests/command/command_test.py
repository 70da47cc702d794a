#!/usr/bin/env python3
"""What the command says of a run, and how it refuses what nothing reads or what is not there.

usage: command_test.py PLUMB SCRATCH
"""
import json
import pathlib
import re
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
    "run chain --out x": "no option '--out'; `plumb run --help` lists those there are\n",
    "run chain --threads -1": "--threads: '-1' is not a whole number from 0 to 64\n",
    "run chain --threads 1000": "--threads: '1000' is not a whole number from 0 to 64\n",
    "run chain --most-work x": "--most-work: 'x' is not a whole number from 0 to 18446744073709551615\n",
    "stability --shots 0": "--shots: '0' is not a whole number from 1 to 4294967295\n",
    "stability --hangings 0": "--hangings: '0' is not a whole number from 1 to 4294967295\n",
    "stability --scenes ropez": "--scenes: 'ropez' is not one of chains, nets, ropes, drapes, boxes. Did you mean ropes?",
    "scale --methods relaxx": "--methods: 'relaxx' is not one of auto, relax, direct, springs, multipliers, featherstone. "
    "Did you mean relax?",
    "run humanoid:body=medum": "scene 'humanoid:body=medum': body must be one of thin, medium, wide, none, not 'medum'. "
    "Did you mean medium?",
    "run SCRATCH": "no scene 'SCRATCH': it is a folder, and the generators are ",
    "run SCRATCH/empty.json": "SCRATCH/empty.json: the key 'plumb' (version of the format, 1) is missing\n",
    "run chain --duration 2 --resume SCRATCH/chain.snapshot --method relax": "SCRATCH/chain.snapshot: is of a run with "
    "another --method: \"auto\", and not \"relax\"",
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
    # What stands still sleeps without touching: the net hangs at rest from the start on.
    "run net:width=4 --duration 0.4 --sleep-time 0.2": "islands that fell asleep: 1",
    "run drop --duration 0.1": "direct    solved all at once, gradient ",
    "run drop --duration 0.1 --method relax": "relax     gauss-seidel, gradient new",
    "view --help": "`tools/setup --ports`",
    "info SCRATCH/bare.json": "shapes     2 movable particles have no shape (capsules, hulls), and will",
    "info chain:links=3": "bytes/projection",
    "run net:width=4 --help": "This scene, with its parameters as they are by default:\n  net:width=32,",
    "run --help": "  net:width=32,",
}

# What is typed, and what is not printed, since it would be empty or of no use.
LEFT_OUT = {
    "info rope": "bytes/projection",
    "run net --help": "six rods with mass that branch",
    "run drop --duration 0.2": "stretch",
    "run SCRATCH/nothing.json": "relax ",
    "run net:width=4 --duration 0.4": "fell asleep",
}

# Options of `run` that are no settings: what is read, what is written, and what is printed.
NO_SETTINGS = """--help --save-at --trajectory --forces --end-scene --vtk --gltf --save --save-every --resume --stages
--truth --truth-tensions --report --replay --quiet""".split()
# Some settings: the name in a report, what is typed, and the value in the report.
SETTINGS = {
    "--most-work": ("most_work", "500", 500),
    "--sleep-time": ("sleep_time", "0.7", 0.7),
    "--length-scale": ("length_scale", "2", 2),
    "--winch": ("winch", "0:-0.1,2:0.5", "0:-0.1,2:0.5"),
    "--contacts": ("contacts", "SCRATCH/contacts.csv", True),
}

# A rod above a plane, without a capsule.
BARE = {
    "plumb": 1,
    "particles": [{"position": [x, 1, 0], "mass": 1} for x in (0, 1)],
    "rods": [{"a": 0, "b": 1}],
    "planes": [{"normal": [0, 1, 0]}],
}
# A rod of 0.8 m between particles that are 1 m apart.
STRAINED = {**BARE, "rods": [{"a": 0, "b": 1, "length": 0.8}], "planes": []}
SCENES = {"bare": BARE, "strained": STRAINED, "empty": {}, "nothing": {"plumb": 1, "particles": []}}


def run(plumb, typed, scratch):
    words = typed.replace("SCRATCH", str(scratch)).split()
    return subprocess.run([plumb, *words], capture_output=True, text=True, check=False)


def complaints_of_report(plumb, scratch):
    """Every option of `run` that sets something is in the report, with its value."""
    options = re.findall(r"^  (?:-h,)?(--[\w-]+)", run(plumb, "run --help", scratch).stdout, re.MULTILINE)
    typed = " ".join(f"{option} {value}" for option, (_, value, _) in SETTINGS.items())
    run(plumb, f"run rope --duration 0.1 --report SCRATCH/report.json {typed}", scratch)
    settings = json.loads((scratch / "report.json").read_text())["settings"]
    spelled = {option: option[2:].replace("-", "_") for option in options} | {"--step-budget": "step_budget_us"}
    missing = [option for option in options if option not in NO_SETTINGS and spelled[option] not in settings]
    wrong = [option for option, (name, _, value) in SETTINGS.items() if settings.get(name) != value]
    return [f"the report lacks {option}" for option in missing] + [f"the report is wrong of {option}" for option in wrong]


def main():
    plumb, scratch = sys.argv[1], pathlib.Path(sys.argv[2])
    scratch.mkdir(parents=True, exist_ok=True)
    for name, scene in SCENES.items():
        (scratch / f"{name}.json").write_text(json.dumps(scene))
    run(plumb, "run chain --save SCRATCH/chain.snapshot", scratch)
    complaints = complaints_of_report(plumb, scratch)
    for typed in [*REFUSED, *PRINTED, *LEFT_OUT]:
        done = run(plumb, typed, scratch)
        if typed in REFUSED:
            message = "plumb: " + REFUSED[typed].replace("SCRATCH", str(scratch))
            is_right = done.returncode == 2 and done.stderr.startswith(message)
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
