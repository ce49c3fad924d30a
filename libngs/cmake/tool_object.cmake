# Links OBJECTS, those of one tool, into the object file OUT, whose only name for others is ENTRY, the former main. Names that
# two tools share by accident, such as those of inline functions of equal types, then stay apart.
function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
separate_arguments(OBJECTS UNIX_COMMAND "${OBJECTS}")
run(${LD} -r --force-group-allocation -o ${OUT} ${OBJECTS})
# objcopy does not make unique names local, but weak ones.
execute_process(COMMAND ${NM} --defined-only ${OUT} OUTPUT_VARIABLE names COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL " u [^\n]+" unique "${names}")
list(TRANSFORM unique REPLACE "^ u " "")
list(JOIN unique "\n" unique)
file(WRITE ${OUT}.unique "${unique}\n")
run(${OBJCOPY} --redefine-sym main=${ENTRY} --weaken-symbols=${OUT}.unique ${OUT})
run(${OBJCOPY} --keep-global-symbol ${ENTRY} ${OUT})
