#pragma once

namespace hybrid::io {

// The number at the start of [at, end), as std::from_chars reads it (identical double, no locale, nan and inf
// known), and with a plus sign, which that does not know; too small for a double is 0. Returns where it ends,
// nullptr when there is none or it is too large for a double.
//
// Decimals as scans hold them, up to 15 digits and a point, take a path of their own: digits eight at a time,
// then one division. It is exact because both operands are (whole number below 2^53, power of ten to 10^22)
// and a division of exact operands rounds once (Clinger 1990). Everything else goes to std::from_chars.
const char* parse_number(const char* at, const char* end, double& value);

}  // namespace hybrid::io
