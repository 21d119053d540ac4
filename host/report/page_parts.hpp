#pragma once

namespace hybrid::report {

// The style sheet and the script inside every page (page_style.cpp, page_script.cpp): no framework, nothing
// loaded from elsewhere.
extern const char* const kPageStyle;
extern const char* const kPageScript;

}  // namespace hybrid::report
