"""The blind benchmark: physics concealed in recordings that the diagnoser has never seen."""
