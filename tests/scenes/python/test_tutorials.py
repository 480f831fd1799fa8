"""Blocks of scenes/examples/tutorials do what the pages say.

Of each page, in the order in which they stand: Python blocks run, with what those before them have defined; `sh` blocks
run the program; what is json or xml becomes the file that its first line names, in which `taut check` finds nothing
wrong; C++ blocks are compiled, and run where there is a library to link with.  A `text` block is what the block above
it has printed: … stands for anything, within a line or as a line of its own, and numbers that are no integers may be
off by one in their last digit.
"""

import contextlib
import io
import os
import pathlib
import re
import shutil
import subprocess

import pytest
from conftest import ROOT

FOLDER = ROOT / "scenes/examples/tutorials"
PAGES = sorted(path.stem for path in FOLDER.glob("*.md") if path.stem != "README")
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.M | re.S)
PIECE = re.compile(r"(?P<lines>^…\n)|(?P<dots>…)|(?P<number>(?<![\w.])[-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?(?!\w))|(?P<space>[ \t]+)", re.M)


def pattern(quoted):
    """What matches a text that says the same, with a group for each number."""
    parts, last = [], 0
    for piece in PIECE.finditer(quoted):
        kinds = {"lines": r"(?:.*\n)*?", "dots": r".*", "number": r"[ \t]*([-+]?\d+(?:\.\d*)?(?:e[-+]?\d+)?)", "space": r"[ \t]*"}
        parts += [re.escape(quoted[last:piece.start()]), kinds[piece.lastgroup]]
        last = piece.end()
    return "".join(parts) + re.escape(quoted[last:])


def unit(number):
    """One in the last digit of a number as it is printed; 0 of an integer."""
    mantissa, _, exponent = number.partition("e")
    if mantissa == number and "." not in number:
        return 0
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def says(quoted, printed):
    match = re.fullmatch(pattern(quoted), printed)
    if not match:
        return False
    numbers = [piece["number"] for piece in PIECE.finditer(quoted) if piece["number"]]
    assert len(numbers) == len(match.groups())
    return all(abs(float(a) - float(b)) <= 1.01 * unit(a) for a, b in zip(numbers, match.groups()))


def test_quoted_text_is_compared():
    quoted = "joints  4 (1 ball)\n…\nspeed …\nswing 0.176 rad, to 4e-06\n"
    printed = "joints     4 (1 ball)\nmore\nand more\nspeed 0.5 s\nswing 0.1761 rad, to 4e-06\n"
    assert says(quoted, printed)
    assert says(quoted, printed.replace("0.1761", "0.1769")) and not says(quoted, printed.replace("0.1761", "0.1773"))
    assert not says(quoted, printed.replace("joints     4", "joints     5"))
    assert not says(quoted, printed.replace("4e-06", "6e-06"))
    assert not says(quoted, printed.replace("ball", "hinge"))
    assert not says(quoted, printed + "more\n")


def run_cpp(text, folder, build):
    """What a C++ block prints; None where there is no library to link with, and it was only compiled."""
    compiler = shutil.which(os.environ.get("CXX", "c++"))
    if not compiler:
        pytest.skip("there is no C++ compiler")
    for name, header in ("taut", "solvers/taut.h"), ("io", "scenes/export/io.h"):
        (folder / "taut").mkdir(exist_ok=True)
        (folder / f"taut/{name}.h").write_text(f'#include "{header}"\n')
    source = folder / "block.cpp"
    source.write_text(text)
    eigen = subprocess.run(["pkg-config", "--cflags", "eigen3"], capture_output=True, text=True)
    eigen = eigen.stdout.replace("-I", "-isystem").split() if eigen.returncode == 0 else ["-isystem/usr/include/eigen3"]
    command = [compiler, "-std=c++20", "-Wall", "-Werror", f"-I{folder}", f"-I{ROOT}", *eigen,
               "-DEIGEN_MAX_ALIGN_BYTES=16", "-DEIGEN_MAX_STATIC_ALIGN_BYTES=16", str(source)]
    if not all((build / name).is_file() for name in ("libtaut.a", "libtaut_io.a", "taut.pc", "taut-io.pc")):
        subprocess.run([*command, "-fsyntax-only"], check=True)
        return None
    libraries = [re.search(r"^Libs: -L\S+ (.*)$", (build / name).read_text(), re.M)[1].split() for name in ("taut-io.pc", "taut.pc")]
    made = folder / "block"
    subprocess.run([*command, "-o", made, f"-L{build}", *sum(libraries, [])], check=True)
    return subprocess.run([made], check=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=folder).stdout


def play(page, folder, program=None):
    """Does what a page says; what its Python blocks define."""
    names, printed, is_new = {}, None, False
    for kind, text in BLOCK.findall((FOLDER / f"{page}.md").read_text()):
        where = f"{page}.md: {text.splitlines()[0]}"
        if kind == "text":
            assert printed is None or says(text, printed), f"{page}.md says\n{text}but it is\n{printed}"
            assert is_new, f"{where}: no block has printed it"
            is_new = False
            continue
        is_new = kind in ("python", "sh", "cpp")
        if kind == "python":
            with contextlib.redirect_stdout(io.StringIO()) as out:
                exec(compile(text, page, "exec"), names)
            printed = out.getvalue()
        elif kind == "sh":
            commands = [line.split() for line in text.splitlines()]
            assert all(words[0] == "taut" for words in commands), where
            runs = [subprocess.run(words, executable=program, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
                    for words in commands]
            assert all(run.returncode == 0 for run in runs), f"{where}: " + "".join(run.stdout for run in runs)
            printed = "".join(run.stdout for run in runs)
        elif kind == "cpp":
            printed = run_cpp(text, folder, pathlib.Path(program).parent)
        else:
            assert kind in ("json", "xml"), f"{where}: blocks of {kind or 'no language'} are not checked"
            name = re.match(r"(?://|<!--) (\S+)", text)[1]
            (folder / name).write_text(text)
            check = subprocess.run([program, "check", name], cwd=folder, capture_output=True, text=True)
            assert check.returncode == 0 and "nothing wrong" in check.stdout, f"{where}: {check.stdout}{check.stderr}"
    return names


@pytest.mark.parametrize("page", PAGES)
def test_blocks(page, tmp_path, monkeypatch, request):
    monkeypatch.chdir(tmp_path)
    with_python_alone = set(kind for kind, _ in BLOCK.findall((FOLDER / f"{page}.md").read_text())) <= {"python", "text"}
    names = play(page, tmp_path, None if with_python_alone else request.getfixturevalue("program"))
    if page == "first_mechanism":
        assert names["world"].time == pytest.approx(1, abs=1e-9)
        assert names["world"].positions[names["rods"][0], 2] < 0  # it has fallen
        assert (names["world"].positions[names["rods"][0]] ** 2).sum() == pytest.approx(0.25, abs=1e-8)  # its hinge holds
    if page == "contacts":
        assert names["weight"] == pytest.approx([0, 0, 20 * 9.81], abs=1e-6)
