"""Tables of files in the READMEs, made from the first sentence of each file's comment.

A README holds them between the marks BEGIN and END. What stands around the marks is written by hand.
"""

import re
from pathlib import PurePosixPath

from layout import read_libraries
from tree import header_comment

BEGIN = "<!-- files: made by tests/repository/repository_test.py --write -->"
END = "<!-- end of files -->"
READMES = ("noise/README.md", "warp/README.md", "reference/README.md", "tests/README.md")


def first_sentence(text):
    """What a file's comment begins with, up to the first full stop or colon, without citations, as one table cell."""
    paragraph = re.split(r"\n\s*\n", header_comment(text).strip("\n"))[0]
    words = " ".join(paragraph.split())
    words = re.sub(r"\s*\((?:[^()]*PHYSICS\.md[^()]*|[^()]*\*(?:paper|corrected|added)\*[^()]*)\)", "", words)
    words = re.split(r"(?<=[\w)`}\]²³])(?:[.:;](?=\s|$))", words)[0].strip()
    return words.replace("|", "\\|")


def described(tree, path):
    """The description of a file, or None where it has no comment to take it from."""
    if sentence := first_sentence(tree.text(path)):
        return sentence
    first = re.search(r'#include "((?:noise|warp|reference)/[^"]+)"', tree.text(path))
    return f"Tests of `{first.group(1)}`" if first and path.startswith("tests/") else None


def listed_files(tree, top):
    """Files that the README of a top-level folder lists: headers, of tests everything."""
    if top == "tests":
        return [f for f in tree.files if f.startswith("tests/") and f.endswith((".h", ".cpp", ".py", ".sh"))]
    return [f for f in tree.files if f.startswith(top + "/") and f.endswith(".h")]


def folder_title(tree, folder):
    """The folder, and for a library the folders whose headers it may include."""
    for library in read_libraries(tree).values():
        if library.folder == folder:
            libraries = read_libraries(tree)
            seen = sorted({libraries[n].folder for n in library.public + library.private})
            kind = "Program" if library.program else "Library"
            return f"### {folder}\n{kind} `{library.name}`. " + (
                "It may include from " + ", ".join(f"`{s}`" for s in seen) + " and what these may." if seen else
                "It includes from no other folder.")
    return f"### {folder}"


def table(tree, top):
    """All tables of one README, a section a folder."""
    by_folder = {}
    for path in listed_files(tree, top):
        by_folder.setdefault(str(PurePosixPath(path).parent), []).append(path)
    sections = []
    for folder in sorted(by_folder):
        rows = [f"| `{PurePosixPath(p).name}` | {described(tree, p) or ''} |" for p in by_folder[folder]]
        sections.append("\n".join([folder_title(tree, folder), "", "| File | Holds |", "|---|---|", *rows]))
    return "\n\n".join([BEGIN, *sections, END])


def with_tables(text, made):
    """The text of a README with its tables replaced; None if it has no marks."""
    start, end = text.find(BEGIN), text.find(END)
    return None if start < 0 or end < start else text[:start] + made + text[end + len(END):]


def check_tables(tree):
    """The READMEs list exactly the files that there are."""
    problems = []
    for readme in READMES:
        top = readme.split("/")[0]
        problems += [f"{p}:1: has no comment that says what it holds: begin the file with one sentence"
                     for p in listed_files(tree, top) if not described(tree, p)]
        if readme not in tree.files:
            problems.append(f"{readme} is missing")
            continue
        made = with_tables(tree.text(readme), table(tree, top))
        if made is None:
            problems.append(f"{readme}: the marks of the table of files are missing: add '{BEGIN}' and '{END}'")
        elif made != tree.text(readme):
            problems.append(f"{readme}: the table of files is out of date: run tests/repository/repository_test.py --write")
    return problems


def write_tables(tree):
    """Writes the tables anew; returns the READMEs that changed."""
    changed = []
    for readme in READMES:
        made = with_tables(tree.text(readme), table(tree, readme.split("/")[0]))
        if made is not None and made != tree.text(readme):
            (tree.root / readme).write_text(made, encoding="utf-8")
            changed.append(readme)
    return changed
