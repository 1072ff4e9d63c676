"""What all pictures share: how each thing looks, the paper that they are drawn for, marks, legends and files."""
