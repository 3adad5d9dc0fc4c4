# A test of the stage's own parts is linked with them.
$B/tests/test_track_lids: $B/tests/test_track_lids.o $(addprefix $B/stages/track/,beside.o corners.o fall.o shut.o) $(TEST_LIB_OBJ) $B/libeyewright.a
	@mkdir -p $(@D)
	@$(CXX) $(SANFLAGS) -fopenmp -Wl,--as-needed -o $@ $^ -lcmocka $(LIBS)
