"""The site of the documentation: what it needs beside the pages in docs/."""
