/// A thread-safe cache of costly values that are pure functions of a whole number.
///
/// A found value is the value that would have been made again. Results therefore never depend on what the cache holds.
/// The cache drops the value that was used least recently when it is full. No function fails, except by std::bad_alloc.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

namespace eikonal {

template <class Value>
class BoundedCache {
  public:
    /// capacity: the most values that are kept, >= 1.
    explicit BoundedCache(std::size_t capacity) : capacity_(capacity) {}

    struct Found {
        std::int64_t key = 0;
        std::shared_ptr<const Value> value;  ///< null: nothing found
    };
    /// The value of the greatest key in [least, most] that the cache holds.
    Found latest(std::int64_t least, std::int64_t most) const {
        const std::lock_guard lock(mutex_);
        Entry* best = nullptr;
        for (Entry& entry : entries_)
            if (entry.key >= least && entry.key <= most && (!best || entry.key > best->key)) best = &entry;
        if (!best) return {};
        best->used = ++clock_;
        return {best->key, best->value};
    }

    /// Stores a value, unless the key is there already.
    void keep(std::int64_t key, std::shared_ptr<const Value> value) const {
        const std::lock_guard lock(mutex_);
        const auto same = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.key == key; });
        if (same != entries_.end()) return;
        if (entries_.size() >= capacity_)
            entries_.erase(std::min_element(entries_.begin(), entries_.end(),
                                            [](const Entry& a, const Entry& b) { return a.used < b.used; }));
        entries_.push_back({key, ++clock_, std::move(value)});
    }

  private:
    struct Entry {
        std::int64_t key;
        std::uint64_t used;
        std::shared_ptr<const Value> value;
    };

    std::size_t capacity_;
    mutable std::mutex mutex_;
    mutable std::vector<Entry> entries_;
    mutable std::uint64_t clock_ = 0;
};

}  // namespace eikonal
