#pragma once
#include <filesystem>
#include <string>

#include "archive/store.hpp"

namespace hybrid::archive {

// A lock on a store that the kernel drops with its holder, however that ends. Runs of the whole plan, plans
// and prunings hold it alone; runs of single units (`--unit`, many at a time on a cluster) share it.
class StoreLock {
 public:
  enum class Sharing { alone, with_units };
  // `what` ("a run") is told to those who find the store taken. With `wait` it waits for the others, saying
  // so; else throws ErrorKind::temporary naming host, process and time of the holder.
  StoreLock(const Store& store, Sharing sharing, const std::string& what, bool wait);
  ~StoreLock();
  StoreLock(const StoreLock&) = delete;
  StoreLock& operator=(const StoreLock&) = delete;

 private:
  int descriptor_ = -1;
};

// UTC, as "2026-11-21 20:15:00".
std::string utc_now();
std::string host_name();

}  // namespace hybrid::archive
