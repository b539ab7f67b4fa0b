// What tests look for in a certificate.
#pragma once

#include <fmt/format.h>

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
  std::string text;
  for (const Check& check : certificate.checks)
    text += fmt::format("{} {} {:.3g} (warn {:.1g}, fail {:.1g}) {}\n", name_of(check.verdict),
                        check.name, check.value, check.warn, check.fail, check.where);
  return text;
}

}  // namespace mbd::test
