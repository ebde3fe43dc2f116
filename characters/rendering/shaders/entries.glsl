// Where the light of a lamp first comes to a surface, and whether that is skin, in one number that the least of is kept.

const float ENTRY_STEP = 1e-5;  // [m]; the numbers of lamps at some metres are exact in 32 bits

float entry_of(float distance, bool skin) { return 2.0 * floor(distance / ENTRY_STEP) + (skin ? 0.0 : 1.0); }

bool enters_skin(float entry) { return mod(entry, 2.0) < 0.5; }

float entry_distance(float entry) { return 0.5 * entry * ENTRY_STEP; }
