#pragma once
#include <new>
#include <stdexcept>

#include "core/error.hpp"

namespace hybrid::io {

// Calls body(); what the library throws goes to explain(its text), which throws our error. Our own errors and
// want of memory pass.
template <typename Body, typename Explain>
void with_exr_errors(const Body& body, const Explain& explain) {
  try {
    body();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    explain(error.what());
  }
}

}  // namespace hybrid::io
