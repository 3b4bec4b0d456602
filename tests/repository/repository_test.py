#!/usr/bin/env python3
"""The repository against its own rules: citations, arrows between folders, tables of files, lengths, entries, packages.

    tests/repository/repository_test.py              checks; exit status 1 if anything is wrong, one line each
    tests/repository/repository_test.py --write      writes the READMEs' tables of files anew, and the paths of
                                                     files that were moved; run `tests/check.sh format --write` after it
    tests/repository/repository_test.py --root DIR   another tree
"""

import argparse
import sys
from pathlib import Path

import citations
import habits
import layout
import tables
from tree import Tree

CHECKS = (
    citations.check_theory,
    citations.check_citations,
    citations.check_cited_back,
    citations.check_paths,
    citations.check_links,
    layout.check_links,
    layout.check_folders,
    layout.check_includes,
    tables.check_tables,
    habits.check_lengths,
    habits.check_lines,
    habits.check_top_level,
    habits.check_foreign,
    habits.check_packages,
    habits.check_tests,
)


def main():
    parser = argparse.ArgumentParser(description="Checks the repository against its own rules.")
    parser.add_argument("--write", action="store_true", help="write the tables of files and the paths of moved files anew")
    parser.add_argument("--root", default=Path(__file__).resolve().parents[2], help="the tree to check")
    arguments = parser.parse_args()
    if arguments.write:
        for path in citations.write_paths(Tree(arguments.root)):
            print(f"{path}: paths of moved files written")
        for readme in tables.write_tables(Tree(arguments.root)):
            print(f"{readme}: table of files written")
        return 0
    tree = Tree(arguments.root)
    problems = [problem for check in CHECKS for problem in check(tree)]
    for problem in problems:
        print(problem)
    print(f"{len(tree.files)} files, {len(CHECKS)} checks, {len(problems)} problems")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
