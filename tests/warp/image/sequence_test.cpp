// Frame ranges, frame file patterns, whole-or-nothing files.
#include "warp/image/sequence.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <utility>

#include "noise/base/error.h"
#include "warp/image/atomic_file.h"

namespace eikonal {
namespace {
namespace fs = std::filesystem;

/// An empty folder that goes away with the test.
struct Folder {
    fs::path path = fs::temp_directory_path() / ("eikonal-sequence-test-" + std::to_string(getpid()));
    Folder() {
        fs::remove_all(path);
        fs::create_directories(path);
    }
    ~Folder() { fs::remove_all(path); }
    void touch(const std::string& name) const { std::ofstream(path / name) << "x"; }
    std::size_t files() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(path), fs::directory_iterator()));
    }
};

TEST(Frames, EveryForm) {
    using Frames = std::vector<int>;
    EXPECT_EQ(parse_frames("7"), Frames({7}));
    EXPECT_EQ(parse_frames("1001-1004"), Frames({1001, 1002, 1003, 1004}));
    EXPECT_EQ(parse_frames("1-9x2"), Frames({1, 3, 5, 7, 9}));
    EXPECT_EQ(parse_frames("1-9:4"), Frames({1, 5, 9}));
    EXPECT_EQ(parse_frames("1-8x4"), Frames({1, 5}));
    EXPECT_EQ(parse_frames("-5--3"), Frames({-5, -4, -3}));
    EXPECT_EQ(parse_frames("-3-1"), Frames({-3, -2, -1, 0, 1}));
    EXPECT_EQ(parse_frames("-7"), Frames({-7}));
    EXPECT_EQ(parse_frames("3-1"), Frames({3, 2, 1}));
    EXPECT_EQ(parse_frames("5-5x3"), Frames({5}));
    EXPECT_EQ(parse_frames("9, 1-3 ,2-4"), Frames({9, 1, 2, 3, 4})) << "the user's order, repeats dropped";
    EXPECT_EQ(parse_frames("2147483646-2147483647").size(), 2u);
}

TEST(Frames, BadInputNamesTheText) {
    for (const char* text : {"",
                             ",",
                             "1,",
                             "a",
                             "1-",
                             "1--",
                             "1-x2",
                             "1-9x",
                             "1-9x0",
                             "1-9x-2",
                             "1-9y2",
                             "1 2",
                             "1.5",
                             "+3",
                             "99999999999",
                             "1-99999999999",
                             "1-20000000",
                             "-2147483648-2147483647",
                             "1-9x2x2",
                             "-"}) {
        try {
            parse_frames(text);
            ADD_FAILURE() << "accepted '" << text << "'";
        } catch (const UserError& error) {
            EXPECT_NE(std::string(error.what()).find("'" + std::string(text) + "'"), std::string::npos) << error.what();
        }
    }
}

TEST(Frames, NumbersBeyondTheLimitNameIt) {
    for (const char* text : {"1-100000000000", "99999999999", "5,-99999999999", "2147483648"}) {
        try {
            parse_frames(text);
            ADD_FAILURE() << "accepted '" << text << "'";
        } catch (const UserError& error) {
            EXPECT_NE(std::string(error.what()).find("±2147483647"), std::string::npos) << error.what();
        }
    }
}

TEST(Pattern, NumberInTheNameOfASingleFile) {
    struct Case {
        const char* name;
        int number;  ///< 0: none
        bool after_dot;
    };
    for (const Case& c : {Case{"a/plate.1002.exr", 1002, true},
                          {"plate.0007.exr", 7, true},
                          {"plate.1234567.png", 1234567, true},
                          {"IMG_1234.jpg", 1234, false},
                          {"plate_v2_0010.exr", 10, false},
                          {"plate.exr", 0, false},
                          {"plate.100.exr", 0, false},
                          {"plate.12345678.exr", 0, false},
                          {"IMG_20260101.jpg", 0, false},
                          {"plate1002.exr", 0, false},
                          {"1002.exr", 0, false},
                          {".1002.exr", 0, false},
                          {"plate.1002", 0, false},
                          {"plate.1002a.exr", 0, false},
                          {"shot.1002/plate.exr", 0, false}}) {
        const auto found = number_in_name(c.name);
        ASSERT_EQ(found.has_value(), c.number != 0) << c.name;
        if (!found) continue;
        EXPECT_EQ(found->number, c.number) << c.name;
        EXPECT_EQ(found->after_dot, c.after_dot) << c.name;
    }
}

TEST(Pattern, NamesOfFrames) {
    const auto at = [](const char* text, int frame) { return FilePattern::parse(text).at(frame).string(); };
    EXPECT_EQ(at("a/plate.####.exr", 12), "a/plate.0012.exr");
    EXPECT_EQ(at("plate.####.exr", 123456), "plate.123456.exr");
    EXPECT_EQ(at("plate.####.exr", -12), "plate.-0012.exr");
    EXPECT_EQ(at("plate.#.exr", 7), "plate.0007.exr");
    EXPECT_EQ(at("plate.@.exr", 7), "plate.7.exr");
    EXPECT_EQ(at("plate.@@@.exr", 7), "plate.007.exr");
    EXPECT_EQ(at("plate.##.exr", 7), "plate.07.exr");
    EXPECT_EQ(at("plate.%04d.exr", 7), "plate.0007.exr");
    EXPECT_EQ(at("plate.%d.exr", 7), "plate.7.exr");
    EXPECT_EQ(at("take#1_####.png", 3), "take#1_0003.png") << "the last run counts";
    EXPECT_EQ(at("still.exr", 3), "still.exr");
    EXPECT_EQ(at("100%.exr", 3), "100%.exr");
    EXPECT_FALSE(FilePattern::parse("dir.####/still.exr").is_sequence());
}

TEST(Pattern, FindsExactlyItsOwnFrames) {
    const Folder folder;
    for (const char* name : {"p.0001.exr", "p.0010.exr", "p.-0003.exr", "p.12345.exr", "p.7.exr", "p.00011.exr",
                             "p.0002.png", "p.000x.exr", "q.0004.exr", ".p.0005.eikonal-h-1-1.exr"})
        folder.touch(name);
    EXPECT_EQ(FilePattern::parse(folder.path / "p.####.exr").find_frames(), std::vector<int>({-3, 1, 10, 12345}));
    EXPECT_EQ(FilePattern::parse(folder.path / "p.@.exr").find_frames(), std::vector<int>({7, 12345}));
    EXPECT_TRUE(FilePattern::parse(folder.path / "none.####.exr").find_frames().empty());
    EXPECT_THROW(FilePattern::parse(folder.path / "missing/p.####.exr").find_frames(), FrameError);
}

TEST(Movie, ByExtension) {
    for (const char* name : {"a.mp4", "a.MOV", "dir.exr/a.mkv", "a.avi", "a.webm", "a.m4v", "a.mxf", "a.mpg", "a.ts"})
        EXPECT_TRUE(is_movie(name)) << name;
    for (const char* name : {"a.exr", "mp4", "a.mp4.png", "a.mov/b.exr", ""}) EXPECT_FALSE(is_movie(name)) << name;
}

TEST(AtomicFile, AppearsOnlyWhenCommitted) {
    const Folder folder;
    const fs::path target = folder.path / "out.0001.exr";
    {
        AtomicFile file(target);
        EXPECT_EQ(file.temporary().extension(), ".exr");
        EXPECT_EQ(file.temporary().parent_path(), folder.path);
        std::ofstream(file.temporary()) << "half";
        EXPECT_TRUE(FilePattern::parse(folder.path / "out.####.exr").find_frames().empty());
    }
    EXPECT_EQ(folder.files(), 0u) << "an abandoned temporary stays";
    AtomicFile file(target);
    EXPECT_THROW(file.commit(), FrameError) << "nothing written";
    std::ofstream(file.temporary()) << "whole";
    AtomicFile moved = std::move(file);
    moved.commit();
    EXPECT_TRUE(fs::exists(target));
    EXPECT_EQ(folder.files(), 1u);
    write_text_file(target, "again");
    EXPECT_EQ(fs::file_size(target), 5u);
}

TEST(AtomicFile, RefusesBadTargets) {
    const Folder folder;
    EXPECT_THROW(AtomicFile(folder.path / "missing" / "a.exr"), FrameError);
    EXPECT_THROW(AtomicFile("/dev/null"), FrameError);
    EXPECT_THROW(AtomicFile(folder.path / ""), FrameError);
    folder.touch("file");
    EXPECT_THROW(AtomicFile(folder.path / "file" / "a.exr"), FrameError);
    const std::string longest(250, 'n');
    EXPECT_LE(AtomicFile(folder.path / (longest + ".exr")).temporary().filename().string().size(), 255u);
}

TEST(AtomicFile, ClearsWhatAKilledRunLeft) {
    const Folder folder;
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {  // dies in the middle of a frame
        AtomicFile file(folder.path / "out.0001.exr");
        std::ofstream(file.temporary()) << "half";
        _exit(0);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(folder.files(), 1u);
    AtomicFile own(folder.path / "out.0002.exr");
    std::ofstream(own.temporary()) << "in the making";
    remove_stale_temporaries(folder.path);
    EXPECT_TRUE(fs::exists(own.temporary()));
    EXPECT_EQ(folder.files(), 1u);
}

}  // namespace
}  // namespace eikonal
