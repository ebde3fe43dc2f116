// Share of a character's height that counts as near the table, see light_around.
const float NEAR_TABLE = 0.28;
