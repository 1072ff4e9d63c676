# What an installed package holds beside code: the paper's controllers, and the firmware of both boards, so that flashing
# needs neither a compiler nor PlatformIO. The images lie where PlatformIO builds them; an sdist brings them along.
install(DIRECTORY ${REPOSITORY}/shared/fuzzy_tables DESTINATION greywhale/data FILES_MATCHING PATTERN "*.toml")

set(MEGA ${REPOSITORY}/firmware/.pio/build/megaatmega2560/firmware.hex)
set(NANO ${REPOSITORY}/firmware/.pio/build/nanoatmega328/firmware.hex)
execute_process(COMMAND ${Python_EXECUTABLE} -B ${REPOSITORY}/firmware/source_digest.py ${MEGA} ${NANO}
                RESULT_VARIABLE IMAGES_STATUS ERROR_VARIABLE IMAGES_PROBLEM)
if(NOT IMAGES_STATUS EQUAL 0)
  message(FATAL_ERROR "${IMAGES_PROBLEM}")
endif()
install(FILES ${MEGA} DESTINATION greywhale/data/firmware RENAME mega.hex)
install(FILES ${NANO} DESTINATION greywhale/data/firmware RENAME nano.hex)
