#include "core/log.hpp"

int main() {
  hybrid::log::info("hybrid");
}
