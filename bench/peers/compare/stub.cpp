namespace hybrid::compare { int stub(); int stub() { return 1; } }
