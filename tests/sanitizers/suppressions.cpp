// Leaks of other libraries that LeakSanitizer is not to report, which are theirs when they are given wrong input.

// Read by LeakSanitizer at its start (its documentation: "Suppressions"); each line names a library.
extern "C" const char* __lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "leak:libudunits2\n"  // names in texts that are no unit (utlex), some bytes each
         "leak:libassimp\n";   // what it had read of a file, when it finds it wrong
}
