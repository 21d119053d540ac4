#pragma once
#include <filesystem>
#include <memory>
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

// A lock on one key of a store, by which one of the runs of single units makes it and the others wait. The
// kernel drops it with its holder, too. A byte of one file for each key: two keys share one by chance in
// 10^18, and then wait for each other.
class KeyLock {
 public:
  // Null while another holds it. Throws ErrorKind::failed where the file cannot be locked.
  static std::unique_ptr<KeyLock> try_lock(const Store& store, const std::string& key);
  ~KeyLock();
  KeyLock(const KeyLock&) = delete;
  KeyLock& operator=(const KeyLock&) = delete;

 private:
  explicit KeyLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

// UTC, as "2026-11-21 20:15:00".
std::string utc_now();
std::string host_name();

}  // namespace hybrid::archive
