"""What `against` and `record` share: the cases, and how one is run."""
import os, pathlib, subprocess, sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def fail(text):
    sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {text}")


def read_cases(names=()):
    """The arguments of each case of cases.txt, or of those named."""
    cases = {}
    for line in (ROOT / "tests/golden/cases.txt").read_text().splitlines():
        if line and not line.startswith("#"):
            name, arguments = line.split(":", 1)
            cases[name] = arguments.split()
    unknown = set(names) - set(cases)
    if unknown:
        fail(f"no case {', '.join(sorted(unknown))} in cases.txt")
    return {name: cases[name] for name in cases if not names or name in names}


def run_case(program, arguments, folder=ROOT, variables={}):
    """`program` is a list: an emulator may come first."""
    return subprocess.run([*program, "run", *arguments, "--threads", "1", "--quiet"], cwd=folder, capture_output=True,
                          text=True, env={**os.environ, "OPENBLAS_NUM_THREADS": "1", **variables})
