"""Lays out what the site shows in build/site/pages: the pages of the tree, and what they link to.

A README.md becomes the index.md of its folder, every other page keeps its place.  Relative links become links to what
the site has instead: of a public header the reference, of any other source or of a folder a page that shows it, of a
notebook the executed copy, of a table of numbers the file.  Citations such as (core/joints, Eq. 3) and [Andersen1983] become
links.  What leads nowhere is an error.
"""

import importlib.machinery
import importlib.util
import json
import pathlib
import posixpath
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
SITE = "cmake/site/"


def script(path):
    """The names of a script of the tree, which has no ending."""
    loader = importlib.machinery.SourceFileLoader(path.name, str(path))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(path.name, loader))
    loader.exec_module(module)
    return module


ROOMS = script(ROOT / "tests/architecture/rooms")  # which checks what becomes links here
UNSEEN = ".github/", "tests/fuzz/corpus/"
PICTURES = ".png", ".svg"
FILES = *PICTURES, ".csv", ".json", ".obj"  # linked as they are; json: results of benchmarks, not scenes
LANGUAGES = {".h": "cpp", ".cpp": "cpp", ".py": "python", ".sh": "bash", ".json": "json5", ".mjs": "javascript"}
LINK = re.compile(r"(?<!`)\]\((<?)([^()\s>]+)(>?)\)")
CODE = re.compile(r"^(?P<fence>```+)[\s\S]*?^(?P=fence)$|^ {4,}\S.*$|(?P<tick>`+)(?!`)[^\n]+?(?<!`)(?P=tick)(?!`)", re.M)
KEY = re.compile(r"\[([A-Z][^\W\d_]+ ?\d{4})((?:,[^\]]*)?)\](?!\()")


def slug(title):
    """The anchor of a heading, as GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


class Stage:
    def __init__(self, pages, public_headers, notebooks):
        """@param notebooks  the folder of executed copies of the notebooks"""
        self.pages = pages
        self.notebooks = notebooks
        self.headers = set(public_headers) - {"solvers/taut.h"}
        listed = subprocess.run(["git", "-C", ROOT, "ls-files", "--cached", "--others", "--exclude-standard"],
                                capture_output=True, text=True, check=True).stdout.split()
        self.names = {name for name in listed if (ROOT / name).is_file()}
        self.folders = {str(folder) for name in self.names for folder in pathlib.PurePosixPath(name).parents} - {"."}
        self.linked = []  # sources, folders and files that pages link to
        self.problems = []

    def place(self, name):
        """Where the site has the page `name`."""
        if name.startswith(SITE + "pages/"):
            return name.removeprefix(SITE + "pages/")
        if name == "README.md":
            return "overview.md"
        return re.sub(r"(^|/)README\.md$", r"\1index.md", name)

    def target(self, path):
        """Where the site has a file or folder of the tree."""
        if path in self.folders:
            if f"{path}/README.md" in self.names:
                return self.place(f"{path}/README.md")
            self.linked.append(path)
            return f"{path}/contents.md"
        if path.endswith(".md"):
            return self.place(path)
        if path in self.headers:
            return f"api/cpp/{path.removesuffix('.h')}.md"
        self.linked.append(path)
        if path.endswith(PICTURES if path.startswith("scenes/examples/") else FILES):
            return path
        return path if path.endswith(".ipynb") else f"{path}.md"

    def link(self, name, target):
        """A link of the page `name`, for its place on the site."""
        there, hash_, anchor = target.partition("#")
        if ":" in target or not there:
            return target
        path = posixpath.normpath(posixpath.join(posixpath.dirname(name), there))
        if path not in self.names | self.folders:
            self.problems.append(f"{name}: {target} is not there")
            return target
        return self.link_from_root(name, path) + hash_ + anchor

    def citation(self, name, match):
        page = next((p for p in (f"{match[1]}/README.md", f"{match[1]}.md") if p in self.names), None)
        if not page:
            return match[0]
        first = re.match(r'"(.*)"', match[2])
        anchor = "#" + slug(re.sub(r"\s+", " ", first[1])) if first else ""
        if page == name and not anchor:
            return match[0]
        return f"[{match[0]}]({self.link_from_root(name, page)}{anchor})"

    def link_from_root(self, name, path):
        return posixpath.relpath(self.target(path), posixpath.dirname(self.place(name)) or ".")

    def prose(self, name, text):
        """What is no code: links and citations lead to their places on the site."""
        text = LINK.sub(lambda m: f"]({m[1]}{self.link(name, m[2])}{m[3]})", text)
        if name != ROOMS.SOURCES:
            text = KEY.sub(lambda m: f"[\\[{m[1]}{m[2]}\\]]({self.link_from_root(name, ROOMS.SOURCES)})", text)
        return ROOMS.CITATION.sub(lambda m: self.citation(name, m), text)

    def page(self, name):
        text = (ROOT / name).read_text()
        parts, last = [], 0
        for match in CODE.finditer(text):
            parts += [self.prose(name, text[last:match.start()]), match[0]]
            last = match.end()
        self.write(self.place(name), "".join(parts) + self.prose(name, text[last:]))

    def notebook(self, path):
        """The executed copy, which shows what the cells of the notebook as it is now give."""
        notebook, executed = json.loads((ROOT / path).read_text()), self.notebooks / pathlib.PurePosixPath(path).name
        copy = json.loads(executed.read_text()) if executed.is_file() else {"cells": []}
        sources = lambda cells: [(cell["cell_type"], "".join(cell["source"])) for cell in cells]
        if sources(notebook["cells"]) != sources(copy["cells"]):
            self.problems.append(f"{path}: {executed} is not what it gives; run scenes/python/notebooks/run.py --out {self.notebooks}")
        for cell in copy["cells"]:
            if cell["cell_type"] == "markdown":
                cell["source"] = self.prose(path, "".join(cell["source"]))
        self.write(path, json.dumps(copy))
        self.places.append(path)

    def folder(self, path):
        within = sorted({name.removeprefix(path + "/").split("/")[0] for name in self.names if name.startswith(path + "/")})
        lines = [f"# {path}/", ""]
        for entry in within:
            inner = f"{path}/{entry}"
            shown = inner in self.names or f"{inner}/README.md" in self.names
            if shown and (path == "scenes/examples" or inner.endswith(".md") or inner in self.folders):
                lines.append(f"* [{entry}]({posixpath.relpath(self.target(inner), path)})")
            elif inner in self.folders:
                lines.append(f"* {entry}/")
                for page in sorted(n for n in self.names if n.startswith(inner + "/") and n in self.pages):
                    lines.append(f"  * [{page.removeprefix(inner + '/')}]({posixpath.relpath(self.target(page), path)})")
            else:
                lines.append(f"* `{entry}`")
        self.write(f"{path}/contents.md", "---\norphan: true\n---\n" + "\n".join(lines) + "\n")

    def source(self, path):
        text = (ROOT / path).read_text()
        suffix = pathlib.PurePosixPath(path).suffix
        language = LANGUAGES.get(suffix, "bash" if text.startswith("#!") else "text")
        fence = "`" * 4
        self.write(f"{path}.md", f"---\norphan: true\nnosearch: true\n---\n# {path}\n\n{fence}{language}\n{text}{fence}\n")

    def file(self, path):
        target = self.pages_folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes((ROOT / path).read_bytes())

    def write(self, place, text):
        target = self.pages_folder / place
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text)

    def contents(self):
        """Each page is listed by the page of the folder nearest above it, where the first page does not list it."""
        first = (self.pages_folder / "index.md").read_text()
        listed = set(re.findall(r"^(?:[\w ]+ <)?([\w/.-]+)>?$", first, re.M))
        children = {}
        for place in self.places:
            document = re.sub(r"\.(md|ipynb)$", "", place)
            folders = [str(folder) for folder in pathlib.PurePosixPath(place).parents]
            above = next((f"{folder}/index" for folder in folders if f"{folder}/index.md" in self.places
                          and f"{folder}/index" != document), None)
            if document in listed or document == "index":
                continue
            if above is None:
                self.problems.append(f"{place}: no page lists it; add it to cmake/site/pages/index.md")
                continue
            children.setdefault(above, []).append(document)
        for above, its in children.items():
            text = (self.pages_folder / f"{above}.md").read_text()
            rows = self.sorted([posixpath.relpath(document, posixpath.dirname(above)) for document in its], text, above)
            with open(self.pages_folder / f"{above}.md", "a") as page:
                page.write("\n```{toctree}\n:hidden:\n\n" + "\n".join(rows) + "\n```\n")

    @staticmethod
    def sorted(rows, text, above):
        """Rooms in the order in which they may include each other, then other pages as the text above links to them."""
        def place(row):
            room = posixpath.normpath(posixpath.join(posixpath.dirname(above), posixpath.dirname(row)))
            link = max(text.find(f"]({row}.{ending}") for ending in ("md", "ipynb"))
            return (not row.endswith("/index"), ROOMS.ORDER.index(room) if room in ROOMS.ORDER else len(ROOMS.ORDER),
                    link if link >= 0 else len(text), row)
        return sorted(rows, key=place)

    def run(self, pages_folder):
        self.pages_folder = pages_folder
        self.places = [self.place(name) for name in self.pages]
        for name in self.pages:
            self.page(name)
        done = set()
        while self.linked:
            path = self.linked.pop()
            if path in done:
                continue
            done.add(path)
            if path in self.folders:
                self.folder(path)
            elif path.endswith(".ipynb"):
                self.notebook(path)
            elif self.target(path) == path:
                self.file(path)
            else:
                self.source(path)
        self.contents()
        return self.problems
