"""Pages of the C++ reference from what doxygen says of the public headers: one a header, in the order of the header."""

import pathlib
import re
import xml.etree.ElementTree as ElementTree

FIRST = "solvers/taut.h"  # which only includes
ABOVE = """# C++ reference

What `#include <taut/taut.h>` gives, one page a header, all in namespace `taut`. Begin with [World](core/world/world.md),
[hinges](core/joints/hinge.md), [Simulator](solvers/simulator/simulator.md) and [Settings](solvers/common/settings.md).
"""


def escaped(text):
    return re.sub(r"([\\`*_\[\]<>|$#{}])", r"\\\1", re.sub(r"\s+", " ", text or ""))


def inline(node):
    out = escaped(node.text)
    for child in node:
        if child.tag == "computeroutput":
            out += "`" + "".join(child.itertext()).replace("`", "'") + "`"
        elif child.tag not in ("parameterlist", "simplesect", "itemizedlist", "verbatim"):
            out += inline(child)
        out += escaped(child.tail)
    return out


def blocks(node):
    """The paragraphs of a description, in Markdown."""
    for para in node.findall("para"):
        if text := inline(para).strip():
            yield text
        for child in para:
            if child.tag == "verbatim":
                yield "```\n" + (child.text or "").strip("\n") + "\n```"
            elif child.tag == "itemizedlist":
                yield "\n".join("* " + " ".join(blocks(item)) for item in child.findall("listitem"))
            elif child.tag == "simplesect":
                word = {"return": "Returns", "pre": "Before"}.get(child.get("kind"), child.get("kind").capitalize())
                yield f"*{word}:* " + " ".join(blocks(child))
            elif child.tag == "parameterlist":
                for item in child.findall("parameteritem"):
                    names = ", ".join(f"`{''.join(n.itertext()).strip()}`" for n in item.iter("parametername"))
                    yield f"*Throws* {names} " + " ".join(blocks(item.find("parameterdescription")))


def described(node):
    texts = [*blocks(node.find("briefdescription")), *blocks(node.find("detaileddescription"))]
    return "\n\n".join(texts)


def declaration(member):
    kind, text = member.get("kind"), "".join
    if kind == "enum":
        return f"enum class {member.findtext('name')}" if member.get("strong") == "yes" else f"enum {member.findtext('name')}"
    template = member.find("templateparamlist")
    front = ""
    if template is not None:
        front = "template <" + ", ".join(" ".join(text(p.itertext()).split()) for p in template.findall("param")) + ">\n"
    whole = re.sub(r"\btaut::(?:\w+::)*(?=[\w~]+$)", "", member.findtext("definition"))
    return front + re.sub(r"\btaut::", "", whole) + (member.findtext("argsstring") or "") + \
        (" " + text(member.find("initializer").itertext()) if kind == "variable" and member.find("initializer") is not None
         and len(text(member.find("initializer").itertext())) < 80 else "")


class Reference:
    def __init__(self, xml):
        self.xml = pathlib.Path(xml)
        self.compounds, self.by_header = {}, {}
        for compound in ElementTree.parse(self.xml / "index.xml").getroot().findall("compound"):
            if compound.get("kind") in ("class", "struct", "union", "namespace", "file"):
                self.read(compound.get("refid"))

    def read(self, refid):
        node = ElementTree.parse(self.xml / f"{refid}.xml").getroot().find("compounddef")
        self.compounds[refid] = node
        place = node.find("location")
        if node.get("kind") in ("class", "struct", "union"):
            if node.get("prot", "public") == "public":
                self.add(place, node)
        elif node.get("kind") == "namespace":
            for member in node.iter("memberdef"):
                self.add(member.find("location"), member)

    def add(self, place, node):
        self.by_header.setdefault(place.get("file"), []).append((int(place.get("line")), node))

    def member(self, node, depth):
        text = [f"```cpp\n{declaration(node)}\n```", described(node)]
        if node.get("kind") == "enum":
            text += [f"* `{value.findtext('name')}`: " + described(value).replace("\n", " ") for value in node.findall("enumvalue")]
        return "\n\n".join(filter(None, text))

    def type(self, node):
        name = node.findtext("compoundname").removeprefix("taut::")
        bases = ", ".join("".join(base.itertext()) for base in node.findall("basecompoundref"))
        parts = [f"## {escaped(name)}", f"```cpp\n{node.get('kind')} {name}{' : ' + bases if bases else ''}\n```", described(node)]
        for section in node.findall("sectiondef"):
            for member in section.findall("memberdef"):
                if member.get("prot") == "public":
                    parts += [f"### {escaped(name)}::{escaped(member.findtext('name') or '(unnamed)')}", self.member(member, 3)]
        return "\n\n".join(filter(None, parts))

    def page(self, header):
        parts, names = [f"# {header}"], set()
        file = next((node for node in self.compounds.values() if node.get("kind") == "file"
                     and node.find("location").get("file") == header), None)
        parts.append(described(file) if file is not None else "")
        for _, node in sorted(self.by_header.get(header, []), key=lambda item: item[0]):
            if node.tag == "compounddef":
                parts.append(self.type(node))
            else:
                name = node.findtext("name")
                parts += [f"## {escaped(name)}"] if name not in names else []
                names.add(name)
                parts.append(self.member(node, 2))
        return "\n\n".join(filter(None, parts)) + "\n"

    def write(self, headers, pages):
        rooms = {}
        for header in headers:
            if header != FIRST:
                rooms.setdefault(header.rpartition("/")[0], []).append(header)
                page = pages / (header.removesuffix(".h") + ".md")
                page.parent.mkdir(parents=True, exist_ok=True)
                page.write_text(self.page(header))
        lists = [f"```{{toctree}}\n:caption: {room}\n:maxdepth: 1\n\n" + "\n".join(h.removesuffix(".h") for h in its) + "\n```\n"
                 for room, its in rooms.items()]
        (pages / "index.md").write_text("\n".join([ABOVE, *lists]))
