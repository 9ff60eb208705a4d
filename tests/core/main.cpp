// The runner of all doctest cases of the core: `core_tests --help` lists what it can do.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>
