// Runs all doctest cases of the core. `core_tests --help` lists the options.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>
