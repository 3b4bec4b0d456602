#!/usr/bin/env python3
"""The checks of the repository on small trees that are made up: each must pass what is right and find what is wrong."""

import tempfile
import unittest
from pathlib import Path

import citations
import habits
import layout
import tables
from tree import Tree, header_comment

THEORY = ('- [blobs](#blobs)\n- [depth](#depth)\n<a id="blobs"></a>\n## 1. Blobs\n    (1.1)  a = b    paper\n'
          '<a id="depth"></a>\n## 2. Depth\n    (2.1)  c = d    added\n')
CMAKE = """
eikonal_library(noise_math noise/math)
eikonal_library(noise_blobs noise/blobs)
target_link_libraries(noise_blobs PUBLIC noise_math)
eikonal_library(warp_scene warp/scene)
target_link_libraries(warp_scene PRIVATE noise_blobs)
"""


class Case(unittest.TestCase):
    def tree(self, files):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        for path, text in files.items():
            file = Path(folder.name) / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
        return Tree(folder.name)

    def found(self, check, files):
        return check(self.tree(files))

    def assert_finds(self, check, files, *words):
        """Exactly one problem, whose line holds all these words."""
        problems = self.found(check, files)
        self.assertEqual(len(problems), 1, problems)
        for word in words:
            self.assertIn(word, problems[0])


class Citations(Case):
    def test_resolving_lists_of_anchors(self):
        code = "/// (PHYSICS.md#blobs,\n/// #depth)\n/// PHYSICS.md#blobs and #depth; PHYSICS.md#depth to #blobs\n"
        self.assertEqual(self.found(citations.check_citations, {"noise/PHYSICS.md": THEORY, "noise/a.h": code}), [])

    def test_anchor_that_leads_nowhere(self):
        for code in ("/// PHYSICS.md#lens\n", "/// PHYSICS.md#blobs, #lens\n", "/// PHYSICS.md#blobs,\n///     #lens\n"):
            self.assert_finds(citations.check_citations, {"noise/PHYSICS.md": THEORY, "noise/a.h": code}, "noise/a.h:1", "#lens")

    def test_number_in_place_of_an_anchor(self):
        self.assert_finds(citations.check_citations, {"noise/PHYSICS.md": THEORY, "a.cpp": "int a;\n// PHYSICS 11\n"}, "a.cpp:2")

    def test_theory(self):
        check = citations.check_theory
        self.assertEqual(self.found(check, {"noise/PHYSICS.md": THEORY}), [])
        self.assert_finds(check, {"README.md": ""}, "is missing")
        self.assert_finds(check, {"noise/PHYSICS.md": THEORY.replace("(2.1)", "(1.1)")}, "(1.1)", "twice")
        self.assert_finds(check, {"noise/PHYSICS.md": THEORY.replace("- [depth](#depth)\n", "")}, "depth", "index")
        self.assert_finds(check, {"noise/PHYSICS.md": THEORY + '<a id="blobs"></a>\n'}, "blobs", "twice")

    def test_code_of_a_section_cites_it(self):
        theory = THEORY.replace("## 2.", "\nCode: `noise/a.h` (1.1),\n`noise/b.cpp`.\n\n## 2.").replace('<a id="depth"></a>\n\n', "\n") + ""
        self.assertEqual(self.found(citations.check_cited_back, {"noise/PHYSICS.md": theory, "noise/a.h": "/// (PHYSICS.md#blobs)\n"}), [])
        self.assert_finds(citations.check_cited_back, {"noise/PHYSICS.md": theory, "noise/a.h": "/// (PHYSICS.md#depth)\n"},
                          "noise/a.h", "#blobs")

    def test_files_that_comments_name(self):
        good = {"noise/math/erf.h": "/// Tails.\n", "noise/a.cpp": "// As in noise/math/erf.h and erf.h.\n#include <fftw3.h>\n"}
        self.assertEqual(self.found(citations.check_paths, good), [])
        self.assert_finds(citations.check_paths, {"noise/a.cpp": "int a;  // see noise/math/erf.h\n"}, "noise/a.cpp:1", "erf.h")
        self.assert_finds(citations.check_paths, {"noise/a.h": "/// as meet.h says\n"}, "meet.h")
        self.assert_finds(citations.check_paths, {"README.md": "`blobs_test` checks it\n"}, "blobs_test")
        self.assertEqual(self.found(citations.check_paths, {"noise/a.cpp": 'auto a = "noise/no.h";\n'}), [])

    def test_paths_of_moved_files_are_written(self):
        tree = self.tree({"noise/math/erf.h": "/// Tails.\n", "noise/a.cpp": "int a;  // see noise/erf.h, noise/no.h\n",
                          "README.md": "noise/old/erf.h and noise/math/erf.h"})
        self.assertEqual(citations.write_paths(tree), ["README.md", "noise/a.cpp"])
        tree = Tree(tree.root)
        self.assertEqual(tree.text("noise/a.cpp"), "int a;  // see noise/math/erf.h, noise/no.h\n")
        self.assertEqual(tree.text("README.md"), "noise/math/erf.h and noise/math/erf.h")

    def test_links_of_documents(self):
        good = {"README.md": "# Top\n[a](noise/README.md#two-words) [b](#top) [c](https://example.org) [d](noise)",
                "noise/README.md": "## Two `words`\n[up](../README.md)"}
        self.assertEqual(self.found(citations.check_links, good), [])
        self.assert_finds(citations.check_links, {"README.md": "[a](noise/no.md)"}, "no file")
        self.assert_finds(citations.check_links, {"README.md": "# Top\n[a](#bottom)"}, "#bottom")


class Layout(Case):
    def test_arrows_that_cmake_allows(self):
        files = {"CMakeLists.txt": CMAKE, "noise/math/m.h": "", "noise/blobs/b.h": '#include "noise/math/m.h"\n',
                 "warp/scene/s.cpp": '#include "noise/blobs/b.h"\n#include "noise/math/m.h"\n'}
        self.assertEqual(self.found(layout.check_includes, files), [])
        self.assertEqual(self.found(layout.check_links, files), [])

    def test_arrow_against_the_stream(self):
        self.assert_finds(layout.check_includes, {"CMakeLists.txt": CMAKE, "noise/blobs/b.h": "",
                                                  "noise/math/m.h": '\n#include "noise/blobs/b.h"\n'}, "noise/math/m.h:2", "does not link")

    def test_private_links_are_for_sources_only(self):
        self.assert_finds(layout.check_includes, {"CMakeLists.txt": CMAKE, "noise/blobs/b.h": "",
                                                  "warp/scene/s.h": '#include "noise/blobs/b.h"\n'}, "warp/scene/s.h:1")

    def test_files_and_libraries_in_a_circle(self):
        files = {"warp/a.h": '#include "warp/b.h"\n', "warp/b.h": '#include "warp/c.h"\n', "warp/c.h": '#include "warp/a.h"\n'}
        self.assert_finds(layout.check_includes, files, "warp/a.h -> warp/b.h -> warp/c.h -> warp/a.h")
        cmake = CMAKE + "target_link_libraries(noise_math PUBLIC warp_scene)\n"
        problems = self.found(layout.check_links, {"CMakeLists.txt": cmake})
        self.assertTrue(any("noise_math -> warp_scene" in p and "circle" in p for p in problems), problems)

    def test_media_and_programs_have_arrows_too(self):
        noise = CMAKE + "eikonal_library(noise_medium noise/medium)\neikonal_medium(plume noise_math)\n"
        warp = "file(GLOB APP CONFIGURE_DEPENDS app/*.cpp)\nadd_executable(a-b ${APP})\ntarget_link_libraries(a-b PRIVATE noise_plume)\n"
        files = {"noise/CMakeLists.txt": noise, "warp/CMakeLists.txt": warp, "noise/medium/m.h": "", "noise/blobs/b.h": "",
                 "noise/plume/p.h": '#include "noise/medium/m.h"\n', "warp/app/a.cpp": '#include "noise/plume/p.h"\n'}
        self.assertEqual(self.found(layout.check_includes, files), [])
        for path in ("noise/plume/p.h", "warp/app/a.cpp"):
            self.assert_finds(layout.check_includes, files | {path: '#include "noise/blobs/b.h"\n'}, path)

    def test_folders_without_a_library(self):
        cmake = "foreach(part a b)\n  eikonal_library(noise_${part} noise/${part})\nendforeach()\n"
        files = {"noise/CMakeLists.txt": cmake, "noise/a/a.h": "", "noise/b/b.cpp": "", "tests/c/c_test.cpp": ""}
        self.assertEqual(self.found(layout.check_folders, files), [])
        self.assert_finds(layout.check_folders, files | {"noise/c/c.h": ""}, "noise/c")

    def test_what_the_design_forbids(self):
        self.assert_finds(layout.check_includes, {"reference/trace/t.cpp": '#include "warp/displace/d.h"\n', "warp/displace/d.h": ""},
                          "shares no approximation")
        cmake = CMAKE + "eikonal_library(t reference/trace)\ntarget_link_libraries(noise_math PRIVATE t)\n"
        problems = self.found(layout.check_links, {"CMakeLists.txt": cmake})
        self.assertTrue(any("the air knows no tracer" in p for p in problems), problems)

    def test_included_file_that_does_not_exist(self):
        self.assert_finds(layout.check_includes, {"noise/a.cpp": '#include "noise/no.h"\n'}, "does not exist")


class Tables(Case):
    def readmes(self, text):
        return {readme: text for readme in tables.READMES}

    def test_written_tables_pass_and_old_ones_do_not(self):
        files = self.readmes(f"# By hand\n{tables.BEGIN}\n{tables.END}\nThe end.\n")
        files |= {"noise/math/erf.h": "/// Tails of the Gaussian (PHYSICS.md#blobs): they\n/// are smooth.\n", "CMakeLists.txt": CMAKE}
        tree = self.tree(files)
        self.assertTrue(any("out of date" in p for p in tables.check_tables(tree)))
        self.assertEqual(len(tables.write_tables(tree)), 4)
        tree = Tree(tree.root)
        self.assertEqual(tables.check_tables(tree), [])
        text = tree.text("noise/README.md")
        self.assertIn("| `erf.h` | Tails of the Gaussian |", text)
        self.assertTrue(text.startswith("# By hand\n") and text.endswith("The end.\n"), text)
        (tree.root / "noise/math/new.h").write_text("/// A new one.\n")
        self.assertTrue(any("noise/README.md" in p for p in tables.check_tables(Tree(tree.root))))

    def test_marks_and_comments_that_are_missing(self):
        problems = self.found(tables.check_tables, self.readmes("# Nothing\n") | {"noise/a.h": "#pragma once\n"})
        self.assertEqual(sum("marks" in p for p in problems), 4)
        self.assertTrue(any(p.startswith("noise/a.h:1") for p in problems))

    def test_first_sentence(self):
        self.assertEqual(tables.first_sentence("/// One pixel,\n/// of 1.5 kB (see a.h). Not this.\n"), "One pixel, of 1.5 kB (see a.h)")
        self.assertEqual(tables.first_sentence("#!/bin/sh\n# Runs it.\nrun\n"), "Runs it")
        self.assertEqual(tables.first_sentence('"""Words.\n\nMore."""\n'), "Words")
        self.assertEqual(tables.first_sentence("#include <a>\n"), "")


class Habits(Case):
    def test_long_files_need_a_reason(self):
        long = "int a;\n" * (habits.LONGEST_FILE + 1)
        self.assertEqual(self.found(habits.check_lengths, {"a.cpp": "int a;\n" * habits.LONGEST_FILE}), [])
        self.assertEqual(self.found(habits.check_lengths, {"a.cpp": "// All keys.\n// Length: one list.\n" + long}), [])
        self.assert_finds(habits.check_lengths, {"a.cpp": long}, "a.cpp", "401 lines")
        self.assert_finds(habits.check_lengths, {"a.cpp": long + "// Length: too late\n"}, "402 lines")

    def test_long_lines(self):
        self.assertEqual(self.found(habits.check_lines, {"a.h": "/// " + "σ" * 116 + "\n"}), [])
        self.assert_finds(habits.check_lines, {"a.h": "int a;\n/// " + "b" * 117 + "\n"}, "a.h:2", "121")

    def test_top_level(self):
        self.assertEqual(self.found(habits.check_top_level, {"README.md": "", "noise/a.h": ""}), [])
        self.assert_finds(habits.check_top_level, {"docs/a.md": ""}, "docs")

    def test_machine_paths_and_hosts(self):
        self.assertEqual(self.found(habits.check_foreign, {"a.md": "the lattice/work/ and out/farm/ and /usr/share\n"}), [])
        self.assert_finds(habits.check_foreign, {"a.sh": "cd\ncp /home/anna/x .\n"}, "a.sh:2", "/home/anna")
        self.assert_finds(habits.check_foreign, {"a.md": "from " + "deb." + "debian.org"}, "registry")

    def test_packages_have_one_list(self):
        self.assertEqual(self.found(habits.check_packages, {".ci/packages": "libfmt-dev\n", ".ci/install": "apt-get install -y\n"}), [])
        self.assert_finds(habits.check_packages, {"README.md": "needs libfmt-dev\n"}, "libfmt-dev")
        self.assert_finds(habits.check_packages, {"a.sh": "apt-get install foo\n"}, "a.sh:1")

    def test_tests_are_registered(self):
        self.assertEqual(self.found(habits.check_tests, {"tests/a/b_test.cpp": "", "tests/CMakeLists.txt": "eikonal_test(a b x)"}), [])
        self.assert_finds(habits.check_tests, {"tests/a/b_test.cpp": "", "tests/CMakeLists.txt": ""}, "b_test.cpp")


class Comments(unittest.TestCase):
    def test_header_comment_ends_with_the_comment(self):
        self.assertEqual(header_comment("/// A.\n///\n/// B.\n#pragma once\n/// C.\n"), "A.\n\nB.")
        self.assertEqual(header_comment('#!/usr/bin/env python3\n"""A.\n\nB.\n"""\nimport x\n'), "A.\n\nB.")


if __name__ == "__main__":
    unittest.main()
