// What tests look for in a certificate.
#pragma once

#include <sstream>
#include <string>
#include <string_view>

#include "libmbd/results/certificate.hpp"

namespace mbd::test {

// nullptr: there is no such check.
inline const Check* find(const Certificate& certificate, std::string_view name) {
  for (const Check& check : certificate.checks)
    if (check.name == name) return &check;
  return nullptr;
}

// All checks, a line each, for messages.
inline std::string words(const Certificate& certificate) {
  std::ostringstream text;
  for (const Check& check : certificate.checks)
    text << name_of(check.verdict) << ' ' << check.name << ' ' << check.value << " (warn "
         << check.warn << ", fail " << check.fail << ") " << check.where << '\n';
  return text.str();
}

}  // namespace mbd::test
