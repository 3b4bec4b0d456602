/// The memory that a piece of work takes, as the system counts it.
#pragma once

namespace eikonal::reference {

/// Watches the resident memory of the process. The constructor returns free memory to the system, so the work has to
/// ask for its own. Work of other threads counts too. Only one watch may exist at a time.
class MemoryWatch {
  public:
    MemoryWatch();
    /// The most bytes by which resident memory has exceeded its size at the start. 0 if the system does not tell: it
    /// needs /proc, as on Linux.
    double most_grown() const;

  private:
    double start_ = 0;
};

}  // namespace eikonal::reference
