"""The paper reproduced: its statements, computed and judged."""
