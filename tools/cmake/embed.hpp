// Files in a program or library, as the assembler reads them when it is built: `MBD_EMBED(name, file)` declares
// mbd_asset_<name> and mbd_asset_<name>_end. What is embedded is no symbol that a shared library shows.
#pragma once

#define MBD_EMBED(name, file)                                                     \
  __asm__(                                                                        \
      ".pushsection .rodata\n"                                                    \
      ".global mbd_asset_" #name                                                  \
      "\n"                                                                        \
      ".global mbd_asset_" #name                                                  \
      "_end\n"                                                                    \
      ".hidden mbd_asset_" #name                                                  \
      "\n"                                                                        \
      ".hidden mbd_asset_" #name                                                  \
      "_end\n"                                                                    \
      "mbd_asset_" #name                                                          \
      ":\n"                                                                       \
      ".incbin \"" file                                                           \
      "\"\n"                                                                      \
      "mbd_asset_" #name                                                          \
      "_end:\n"                                                                   \
      ".byte 0\n"                                                                 \
      ".popsection\n");                                                           \
  extern "C" __attribute__((visibility("hidden"))) const char mbd_asset_##name[]; \
  extern "C" __attribute__((visibility("hidden"))) const char mbd_asset_##name##_end[]
