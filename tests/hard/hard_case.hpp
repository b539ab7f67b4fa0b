// What a hard case reached, for its row in tests/README.md.
//
// MBD_UPDATE_TABLES=1 mbd_hard_tests writes the rows of the tests that ran; rows of others stay. Costs and errors
// are of the machine that wrote them: a test compares its error with its bound, and nothing with the table.
#pragma once

#include <string>

namespace mbd::test::hard {

struct Row {
  std::string id;         // number of the case and a letter: "1a"
  std::string what;       // "door on three hinges"
  std::string run;        // how to see it: "models/hard/door.xml", or "in C++"
  std::string reference;  // where the right answer comes from: "closed form"
  std::string error;      // reached, its norm, and the bound: "2e-13 of the angle (bound 1e-10)"
  std::string shown;      // what makes the test fail: "gravity + 10 %"
};

// Keeps the row; its cost is the CPU time since the test began. Call it once in a test, at the end.
void record(Row row);

// "2.1e-13 (bound 1.0e-10)"
std::string bounded(double error, double bound);

}  // namespace mbd::test::hard
