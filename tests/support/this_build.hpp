// What these tests are linked with. Said by a source that each program of tests compiles for itself: the tests may come
// from the tree of another preset.
#pragma once

namespace mbd::test {

extern const char* const mbd_program;  // file of the program mbd built with this library
bool sanitized();                      // the library has the instruments of the address sanitizer
bool fixed_orders();                   // it has kernels of fixed beam order

}  // namespace mbd::test
