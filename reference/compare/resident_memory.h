/// Memory that a piece of work takes, as the system counts it.
#pragma once

namespace eikonal::reference {

/// Watches the resident memory of the process. Free memory is given back to the system first, so that what follows has
/// to ask for its own; what other threads do meanwhile counts too. One at a time.
class MemoryWatch {
  public:
    MemoryWatch();
    /// Bytes by which resident memory has exceeded its size at the start at the most; 0 where the system does not tell
    /// (it must have /proc, as Linux has).
    double most_grown() const;

  private:
    double start_ = 0;
};

}  // namespace eikonal::reference
