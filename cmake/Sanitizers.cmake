# -DSTATIOND_SANITIZE=address,undefined | thread | realtime (see CMakePresets.json)
set(STATIOND_SANITIZE "" CACHE STRING "Sanitizers, as -fsanitize= takes them")
# How a test runs under them: the environment and the command put before it.
set(STATIOND_SANITIZER_ENVIRONMENT "")
set(STATIOND_TEST_LAUNCHER "")
if(STATIOND_SANITIZE)
  add_compile_options(-fsanitize=${STATIOND_SANITIZE} -fno-omit-frame-pointer -g)
  add_link_options(-fsanitize=${STATIOND_SANITIZE})
endif()
if(STATIOND_SANITIZE MATCHES "address")
  # Fast DDS frees some of its own objects with another size than it made them with.
  list(APPEND STATIOND_SANITIZER_ENVIRONMENT
    ASAN_OPTIONS=new_delete_type_mismatch=0:detect_stack_use_after_return=1)
endif()
if(STATIOND_SANITIZE MATCHES "undefined")
  add_compile_options(-fno-sanitize-recover=undefined)
  list(APPEND STATIOND_SANITIZER_ENVIRONMENT UBSAN_OPTIONS=print_stacktrace=1)
endif()
if(STATIOND_SANITIZE MATCHES "thread")
  # Debian's libraries are not instrumented: what happens between two of their own accesses is not ours to
  # judge.
  list(APPEND STATIOND_SANITIZER_ENVIRONMENT
    TSAN_OPTIONS=ignore_noninstrumented_modules=1:second_deadlock_stack=1)
  # TSan of clang 14 and gcc 12 dies at start where the kernel randomises more address bits than it was made
  # for (vm.mmap_rnd_bits above 28), so the tests run without randomisation. A container may forbid that.
  execute_process(COMMAND setarch -R true RESULT_VARIABLE no_setarch OUTPUT_QUIET ERROR_QUIET)
  if(NOT no_setarch)
    set(STATIOND_TEST_LAUNCHER setarch -R)
  endif()
endif()
if(STATIOND_SANITIZE MATCHES "realtime")
  # What is marked STATIOND_NONBLOCKING is proved when compiled, and watched when it runs.
  add_compile_options(-Wfunction-effects)
endif()
