/// Work on the rows of a picture in parallel, a few rows at a time. The work on a row must not depend on other rows.
/// The result is then the same for any number of threads.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace eikonal {

inline constexpr int kRowsPerTask = 16;

/// Calls action(begin, end) for runs of rows that together are 0 … rows - 1.
template <class Index, class Action>
void for_row_runs(Index rows, const Action& action) {
    tbb::parallel_for(tbb::blocked_range<Index>(0, rows, kRowsPerTask),
                      [&](const tbb::blocked_range<Index>& run) { action(run.begin(), run.end()); });
}

/// Calls action(y) for every row.
template <class Index, class Action>
void for_rows(Index rows, const Action& action) {
    for_row_runs(rows, [&](Index begin, Index end) {
        for (Index y = begin; y < end; ++y) action(y);
    });
}

}  // namespace eikonal
