"""Builds an on-target suite and runs its ELF with test_testing_command. Reads Unity's lines, needs no Unity library."""

from platformio.test.runners.unity import UnityTestRunner


class CustomTestRunner(UnityTestRunner):
    EXTRA_LIB_DEPS = None

    def configure_build_env(self, env):
        return env

    def stage_uploading(self):
        """The simulated board reads the ELF itself, so building takes the place of uploading."""
        self.options.without_uploading = True
        self.stage_building()
