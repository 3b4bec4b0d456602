// Tells ThreadSanitizer how oneTBB orders memory. A part of every program that is built for -fsanitize=thread.
//
// Debian's libtbb is built without the sanitizer. The sanitizer therefore sees neither the deques by which a task
// reaches another thread nor the buffers between the stages of a pipeline. It reports everything that our threads hand
// to each other as races. Suppressing those reports by name would also suppress real races within the bodies of our
// loops. Instead, the library's entry points that our programs call are defined here, around the library's own. Each
// states exactly the order that oneTBB promises, so that two bodies that run side by side stay unordered.
//
//   a task's spawning         happens before its run
//   all of a loop's tasks     happen before execute_and_wait returns
//   an item leaving a stage   happens before its entry into the next one; calls of a serial stage follow one another
//   small objects             come from malloc, whose reuse of memory the sanitizer knows

#include <dlfcn.h>
#include <sanitizer/tsan_interface.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>

#include <cstdlib>
#include <new>

namespace tbb::detail {
namespace {

/// The library's own function of this mangled name.
template <class Function>
Function* library(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

/// Takes over an order when a call ends, with an exception too.
struct Afterwards {
    void* address;
    ~Afterwards() { __tsan_acquire(address); }
};

/// Stands for a spawned task. One that throws stays, because the library cancels it then.
class Handed final : public d1::task {
  public:
    explicit Handed(d1::task& own) : own_(own) { __tsan_release(this); }
    d1::task* execute(d1::execution_data& data) override {
        __tsan_acquire(this);
        d1::task* const next = own_.execute(data);
        delete this;
        return next;
    }
    d1::task* cancel(d1::execution_data& data) override {
        __tsan_acquire(this);
        d1::task* const next = own_.cancel(data);
        delete this;
        return next;
    }

  private:
    d1::task& own_;
};

/// Beginning and end of one call of parallel_pipeline.
struct Span {
    char begin, end;
};

/// Stands for a stage.
class Stage final : public d1::base_filter {
  public:
    Stage(d1::base_filter& filter, Span& span) : base_filter(mode(filter)), filter_(filter), span_(span) {}
    ~Stage() override {
        filter_.~base_filter();
        r1::deallocate_memory(&filter_);
    }
    void* operator()(void* item) override {
        __tsan_acquire(&span_.begin);
        if (item) __tsan_acquire(item);
        if (is_serial()) __tsan_acquire(this);
        Stage* const outer = current;
        current = this;
        void* const result = filter_(item);
        current = outer;
        if (result) __tsan_release(result);
        if (is_serial()) __tsan_release(this);
        __tsan_release(&span_.end);
        return result;
    }
    void finalize(void* item) override {
        __tsan_acquire(item);
        filter_.finalize(item);
    }
    static thread_local Stage* current;  ///< the one that this thread is in

  private:
    static unsigned mode(d1::base_filter& filter) {
        return (filter.is_serial() ? filter_is_serial : 0) | (filter.is_ordered() ? 0 : filter_is_out_of_order) |
               (filter.object_may_be_null() ? filter_may_emit_null : 0);
    }
    d1::base_filter& filter_;
    Span& span_;
};
thread_local Stage* Stage::current = nullptr;

/// Stands for a node of the tree of stages.
class Node final : public d1::filter_node {
  public:
    Node(const d1::filter_node& node, Span& span) : node_(node), span_(span) {
        if (node.left) left = make(*node.left, span);
        if (node.right) right = make(*node.right, span);
    }
    static d1::filter_node* make(const d1::filter_node& node, Span& span) {
        return new (r1::allocate_memory(sizeof(Node))) Node(node, span);
    }
    d1::base_filter* create_filter() const override {
        return new (r1::allocate_memory(sizeof(Stage))) Stage(*node_.create_filter(), span_);
    }

  private:
    const d1::filter_node& node_;
    Span& span_;
};

}  // namespace

namespace r1 {

void spawn(d1::task& task, d1::task_group_context& context) {
    static const auto real = library<void(d1::task&, d1::task_group_context&)>(
        "_ZN3tbb6detail2r15spawnERNS0_2d14taskERNS2_18task_group_contextE");
    real(*new Handed(task), context);
}

void execute_and_wait(d1::task& task, d1::task_group_context& context, d1::wait_context& wait,
                      d1::task_group_context& waiting) {
    static const auto real =
        library<void(d1::task&, d1::task_group_context&, d1::wait_context&, d1::task_group_context&)>(
            "_ZN3tbb6detail2r116execute_and_waitERNS0_2d14taskERNS2_18task_group_contextERNS2_12wait_contextES6_");
    // The counter that each task decreases in our code; the library alone sees it reach zero.
    static_assert(sizeof wait == 16, "the counter of wait_context follows its version");
    const Afterwards all{reinterpret_cast<char*>(&wait) + 8};
    real(task, context, wait, waiting);
}

void parallel_pipeline(d1::task_group_context& context, std::size_t items, const d1::filter_node& root) {
    static const auto real = library<void(d1::task_group_context&, std::size_t, const d1::filter_node&)>(
        "_ZN3tbb6detail2r117parallel_pipelineERNS0_2d118task_group_contextEmRKNS2_11filter_nodeE");
    Span span{};
    __tsan_release(&span.begin);
    const d1::filter_node_ptr stages(Node::make(root, span));
    const Afterwards all{&span.end};
    real(context, items, *stages);
}

void set_end_of_input(d1::base_filter&) {
    static const auto real =
        library<void(d1::base_filter&)>("_ZN3tbb6detail2r116set_end_of_inputERNS0_2d111base_filterE");
    real(*Stage::current);
}

void* allocate(d1::small_object_pool*& pool, std::size_t size) {
    static char no_pool;  // never looked into, but must not be null
    pool = reinterpret_cast<d1::small_object_pool*>(&no_pool);
    return ::operator new (size, std::align_val_t{d1::task_alignment});
}
void* allocate(d1::small_object_pool*& pool, std::size_t size, const d1::execution_data&) {
    return allocate(pool, size);
}
void deallocate(d1::small_object_pool&, void* object, std::size_t) {
    ::operator delete (object, std::align_val_t{d1::task_alignment});
}
void deallocate(d1::small_object_pool& pool, void* object, std::size_t size, const d1::execution_data&) {
    deallocate(pool, object, size);
}

}  // namespace r1
}  // namespace tbb::detail
