"""The physics: filaments, chains of beads, their loads and their initial states."""
