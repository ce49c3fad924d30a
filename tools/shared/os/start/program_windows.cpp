// A program with the name of a tool: all tools are in ngs.dll (tools/one_program.cpp.in), which looks at that name.
extern "C" int ngs_program(int argc, char** argv);

int main(int argc, char** argv) { return ngs_program(argc, argv); }
