// The doctest main that every native suite is linked with.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

int main(int argc, char** argv) {
    doctest::Context context;
    context.setOption("success", true);  // the test runner reads the names of passing cases too
    context.applyCommandLine(argc, argv);
    return context.run();
}
