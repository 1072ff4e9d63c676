// The doctest main that every native suite is linked with.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

int main(int argc, char** argv) {
    doctest::Context context;
    context.setOption("success", true);     // PlatformIO's parser reads the names of passing cases too
    context.setOption("no-exitcode", true); // and takes failures from the output
    context.applyCommandLine(argc, argv);
    return context.run();
}
