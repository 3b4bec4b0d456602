#include "warp/program/thread_limit.h"

#include <tbb/info.h>

#include "warp/image/picture.h"

namespace eikonal {

ThreadLimit::ThreadLimit(int threads)
    : threads_(threads > 0 ? threads : tbb::info::default_concurrency()),
      control_(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads_)) {
    set_image_threads(threads_);
}

}  // namespace eikonal
