"""The particle damper: one ball rolling on the floor of a cavity, event by event."""
