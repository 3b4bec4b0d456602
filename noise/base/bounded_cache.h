/// The most recently used of values that are costly to make and pure functions of a whole number: what is found here
/// is what would have been made, so results never depend on it. Bounded, thread-safe.
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
    /// capacity >= 1: values kept.
    explicit BoundedCache(std::size_t capacity) : capacity_(capacity) {}

    struct Found {
        std::int64_t key = 0;
        std::shared_ptr<const Value> value;  ///< null: nothing found
    };
    /// The value of the greatest key kept in [least, most].
    Found latest(std::int64_t least, std::int64_t most) const {
        const std::lock_guard lock(mutex_);
        Entry* best = nullptr;
        for (Entry& entry : entries_)
            if (entry.key >= least && entry.key <= most && (!best || entry.key > best->key)) best = &entry;
        if (!best) return {};
        best->used = ++clock_;
        return {best->key, best->value};
    }

    /// Drops the value that was not asked for the longest, if there is no room.
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
