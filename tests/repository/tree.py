"""The files of a source tree, as the checks of the repository read them.

A tree is a folder. Under Git its files are those that are tracked or would be (`git ls-files`), elsewhere all that do not lie in a
build folder. Text is UTF-8.
"""

import functools
import os
import re
import subprocess
from pathlib import Path

CODE = (".h", ".cpp")
SCRIPTS = (".py", ".sh")
TEXT = CODE + SCRIPTS + (".md", ".txt", ".toml", ".gp", ".json", ".cmake", ".in")
TEXT_NAMES = ("packages", "run", "setup", "install", "CMakeLists.txt", ".clang-tidy", ".clang-format", ".gitignore", "LICENSE")


class Tree:
    """Files of one tree, as paths relative to its root with forward slashes."""

    def __init__(self, root):
        self.root = Path(root)

    @functools.cached_property
    def files(self):
        if (self.root / ".git").exists():
            listed = subprocess.run(["git", "-C", str(self.root), "ls-files", "-co", "--exclude-standard", "-z"],
                                    check=True, capture_output=True, text=True).stdout.split("\0")
            return sorted({f for f in listed if f and (self.root / f).is_file()})
        found = []
        for folder, folders, names in os.walk(self.root):
            folders[:] = [f for f in folders if not re.match(r"build|out$|__pycache__", f)]
            found += [(Path(folder) / n).relative_to(self.root).as_posix() for n in names]
        return sorted(found)

    @functools.cached_property
    def folders(self):
        return {parent.as_posix() for f in self.files for parent in Path(f).parents}

    def with_suffix(self, *suffixes):
        return [f for f in self.files if f.endswith(suffixes)]

    def texts(self):
        """Every file that people write, but for meshes and the like."""
        return [f for f in self.files if f.endswith(TEXT) or Path(f).name in TEXT_NAMES]

    @functools.lru_cache(maxsize=None)
    def text(self, path):
        return (self.root / path).read_text(encoding="utf-8")

    def lines(self, path):
        return self.text(path).splitlines()

    def exists(self, path):
        return path in self.files or path in self.folders


def header_comment(text):
    """The words of the first comment of a C++, Python or shell file; an empty line ends a paragraph."""
    text = re.sub(r"\A#!.*\n", "", text)
    if docstring := re.match(r'"""(.*?)"""', text, re.S):
        return docstring.group(1).rstrip()
    words = []
    for line in text.splitlines():
        match = re.match(r"(?:///?|#(?!include|pragma|if|define))\s?(.*)", line)
        if not match:
            break
        words.append(match.group(1).rstrip())
    return "\n".join(words)


def line_of(text, offset):
    return text.count("\n", 0, offset) + 1
